//! What is used of rapier.

pub(super) use rapier2d_f64::parry::query::intersection_test;
pub(super) use rapier2d_f64::prelude::{
    CCDSolver, CoefficientCombineRule, Collider, ColliderBuilder, ColliderHandle, ColliderSet, ContactPair,
    DefaultBroadPhase, Group, ImpulseJointSet, IntegrationParameters, InteractionGroups, InteractionTestMode,
    IslandManager, JointAxesMask, JointAxis, MassProperties, MotorModel, MultibodyJointHandle, MultibodyJointSet,
    NarrowPhase, PhysicsPipeline, Pose, RevoluteJointBuilder, RigidBodyBuilder, RigidBodyHandle, RigidBodySet,
    SharedShape, SoftBodySet, Vector,
};
