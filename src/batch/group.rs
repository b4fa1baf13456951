//! Up to eight runs of one kind, stepped side by side: number k of every quantity is that of run k.
//!
//! Elementary functions, choices and their order are those of the single run, so that each goes on to the same bits.

use super::kind::Kind;
use super::shard::Slot;
use crate::model::Run;
use crate::recording::Recorder;
use crate::rover::Rover;
use crate::scalar::{Arch, LaneAccess, Lanes, Mask, Plain, WIDTH};
use crate::signals::{Command, Signals};
use crate::simulation::{Simulation, Status, StepState};
use crate::terrain::Terrain;
use bekker_modeldescription::Parameters;
use std::cell::Cell;
use std::fmt::Debug;

/// A group on one instruction set.
pub(super) trait Group: Debug + Send + Sync {
    fn kind(&self) -> &Kind;

    /// Places of the runs in the shard.
    fn members(&self) -> &[Option<usize>; WIDTH];

    /// Inner steps that its members have made side by side, summed over them.
    fn steps_made(&self) -> u64;

    /// Takes the run at `index` in, where there is a place left.
    fn join(&mut self, index: usize) -> bool;

    /// Lets the run at `index` go; its motion stays with the group until it is taken out or forgotten.
    fn leave(&mut self, index: usize, slot: &mut Slot);

    /// Makes `steps` inner steps with the members that are active and have not ended.
    fn step(&mut self, slots: &mut [Slot], steps: u64);

    /// Writes the present motion of the member at `index` into `run`.
    fn take_out(&self, index: usize, run: &mut Run);
}

/// A group of `kind` for runs like this one.
pub(super) fn group<A: Arch>(kind: Kind, run: &Run) -> Option<Box<dyn Group>> {
    Some(Box::new(SideBySide::<A>::new(kind, run)?))
}

/// Fewer runs than this go on one by one: eight numbers side by side take as long as a few of them alone.
const FEWEST: usize = 3;

#[derive(Debug)]
struct SideBySide<A: Arch> {
    kind: Kind,
    members: [Option<usize>; WIDTH],
    rover: Rover<Lanes<A>>,
    motion: StepState<Lanes<A>>,
    command: Command<Lanes<A>>,
    signals: Signals<Lanes<A>>,
    step_size: f64,
    /// A member with its motion at the time it joined, which stands in empty places and for members that rest.
    spare: StepState,
    /// Whether the place holds the present motion of its member.
    inside: [bool; WIDTH],
    /// Whether the members' records lag, so that each has to see its signals after every step.
    lags: bool,
    /// Whether members have changed since the constants were set side by side.
    changed: bool,
    steps_made: u64,
}

impl<A: Arch> SideBySide<A> {
    fn new(kind: Kind, run: &Run) -> Option<Self> {
        let simulation = run.in_joint_coordinates()?;
        let rover = side_by_side::<A>(&[simulation.rover(); WIDTH]);
        let lift = |x: f64| Lanes::from(x);
        let state = simulation.state().map(&lift);
        let wheels = rover.wheels.len();
        let command = Command { drive: kind.drive, values: vec![Lanes::from(0.0); wheels] };
        let motion = StepState::new(&rover, state, &command).ok()?;
        Some(Self {
            signals: Signals::of(wheels, rover.links.len()),
            step_size: simulation.step_size(),
            spare: simulation.motion().clone(),
            members: [None; WIDTH],
            inside: [false; WIDTH],
            lags: simulation.lags(),
            changed: true,
            steps_made: 0,
            kind,
            rover,
            motion,
            command,
        })
    }

    /// Sets the constants of the members side by side. One of them stands in for those that are not there.
    fn renew(&mut self, slots: &[Slot]) {
        let members = self.members;
        let simulation = |index: usize| slots.get(index).and_then(|slot: &Slot| slot.run.in_joint_coordinates());
        let Some(one) = members.iter().flatten().find_map(|&index| simulation(index)) else { return };
        // Its motion at rest or on its way, whether or not it is the present one, is sound.
        self.spare.clone_from(one.motion());
        self.rover = side_by_side(&members.map(|member| member.and_then(simulation).unwrap_or(one).rover()));
    }

    /// Members that move in this step.
    fn movers(&self, slots: &[Slot]) -> [bool; WIDTH] {
        self.members.map(|member| {
            let slot = member.and_then(|index| slots.get(index));
            slot.is_some_and(|slot| slot.active && slot.error.is_none() && slot.run.status() == Status::Running)
        })
    }

    /// Commands for the next steps, and how many there are before one of the runs decides anew. Marks where the command
    /// changes; what a controller refuses stops its run.
    fn decide(&mut self, slots: &mut [Slot], movers: &mut [bool; WIDTH], left: u64) -> (u64, [bool; WIDTH]) {
        let (mut steps, mut changed) = (left, [false; WIDTH]);
        for k in 0..WIDTH {
            let Some(slot) = mover(&self.members, slots, movers, k) else { continue };
            match slot.run.decided(left) {
                Ok(until) => steps = steps.min(until),
                Err(error) => {
                    slot.error = Some(error);
                    movers[k] = false;
                    continue;
                }
            }
            for (wheel, place) in self.command.values.iter_mut().enumerate() {
                let value = slot.run.command_of(wheel);
                if place.lane(k).to_bits() != value.to_bits() {
                    place.put(k, value);
                    changed[k] = true;
                }
            }
        }
        (steps, changed)
    }

    /// Takes in those that move and are not inside, under their commands.
    fn let_in(&mut self, slots: &mut [Slot], movers: &mut [bool; WIDTH]) {
        for k in 0..WIDTH {
            let Some(slot) = mover(&self.members, slots, movers, k) else { continue };
            if self.inside[k] {
                continue;
            }
            let applied = slot.run.apply_command();
            let Some(simulation) = slot.run.in_joint_coordinates() else { continue };
            match applied {
                Ok(()) => self.motion.put_in(k, simulation.motion()),
                Err(error) => {
                    slot.error = Some(error);
                    movers[k] = false;
                    continue;
                }
            }
            for (place, &value) in self.command.values.iter_mut().zip(&simulation.command().values) {
                place.put(k, value);
            }
            self.inside[k] = true;
        }
    }

    /// Writes the motion of member `k` out, which from now on goes on by itself.
    fn let_out(&mut self, k: usize, slot: &mut Slot) {
        if std::mem::take(&mut self.inside[k])
            && let Some(simulation) = slot.run.in_joint_coordinates_mut()
        {
            self.motion.take_out(k, simulation.places().motion);
        }
    }

    /// Puts something that moves well where no member moves.
    fn fill(&mut self, movers: &[bool; WIDTH], slots: &mut [Slot]) {
        for k in (0..WIDTH).filter(|&k| !movers[k]) {
            if let Some(slot) = self.members[k].and_then(|index| slots.get_mut(index)) {
                self.let_out(k, slot);
            }
            match self.members[k].and_then(|index| slots.get(index)).and_then(|slot| slot.run.in_joint_coordinates()) {
                Some(simulation) => self.motion.put_in(k, simulation.motion()),
                None => self.motion.put_in(k, &self.spare),
            }
            self.command.values.iter_mut().for_each(|value| value.put(k, 0.0));
        }
    }

    /// Makes up to `steps` inner steps; how many were made, and whether all numbers side by side were sound.
    fn advance(&mut self, slots: &mut [Slot], movers: &mut [bool; WIDTH], steps: u64) -> (u64, bool) {
        for made in 0..steps {
            if self.motion.step(&self.rover, &self.command, self.step_size).is_err() {
                return (made, false);
            }
            if self.lags {
                self.observe(slots, movers, Recorder::step);
            }
            let outcome = self.motion.outcome(&self.rover, self.step_size);
            if !outcome.ended().any() {
                continue;
            }
            for k in (0..WIDTH).filter(|&k| outcome.ended().lane(k)) {
                let Some(slot) = mover(&self.members, slots, movers, k) else { continue };
                movers[k] = false;
                self.inside[k] = false;
                if let Some(simulation) = slot.run.in_joint_coordinates_mut() {
                    self.motion.take_out(k, simulation.places().motion);
                    self.write_signals();
                    self.record(k, simulation, made + 1);
                    *simulation.places().status = outcome.status(k);
                }
                slot.run.sense();
            }
        }
        (steps, true)
    }

    /// The signals at the present time.
    fn write_signals(&mut self) {
        let Self { motion, rover, signals, .. } = self;
        <Lanes<A> as crate::scalar::Scalar>::wide(
            #[inline(always)]
            || {
                motion.integrator.now.sense(rover, &motion.state, &motion.energies, signals);
            },
        );
    }

    /// Lets the recorders of some members take in the present true signals, which stand in the members' own until [`Self::record`].
    fn observe(&mut self, slots: &mut [Slot], members: &[bool; WIDTH], take: fn(&mut Recorder, &mut Signals)) {
        self.write_signals();
        for k in 0..WIDTH {
            let Some(slot) = mover(&self.members, slots, members, k) else { continue };
            if let Some(simulation) = slot.run.in_joint_coordinates_mut() {
                let places = simulation.places();
                self.signals.take_out(k, places.signals);
                take(places.recorder, places.signals);
            }
        }
    }

    /// Shows member `k` its signals as they are recorded, after so many steps more.
    fn record(&mut self, k: usize, simulation: &mut Simulation, steps: u64) {
        self.steps_made += steps;
        let places = simulation.places();
        *places.ticks += steps;
        self.signals.take_out(k, places.signals);
        places.recorder.record(places.signals);
    }

    /// Makes the rest of a step, `left` inner steps, run by run: at least one run has reached a case that only the single
    /// simulation handles. `are_decided` says whether the controllers have made their present decisions.
    fn advance_one_by_one(&mut self, slots: &mut [Slot], movers: [bool; WIDTH], left: u64, are_decided: bool) {
        for k in 0..WIDTH {
            let Some(slot) = mover(&self.members, slots, &movers, k) else { continue };
            if std::mem::take(&mut self.inside[k])
                && let Some(simulation) = slot.run.in_joint_coordinates_mut()
            {
                self.motion.take_out(k, simulation.places().motion);
            }
            slot.error = slot.run.advance_from(left, are_decided).err();
        }
    }
}

/// The slot of member `k`, where it moves.
fn mover<'a>(
    members: &[Option<usize>; WIDTH],
    slots: &'a mut [Slot],
    movers: &[bool; WIDTH],
    k: usize,
) -> Option<&'a mut Slot> {
    movers[k].then(|| slots.get_mut(members[k]?)).flatten()
}

/// Constants of eight rovers side by side.
fn side_by_side<A: Arch>(rovers: &[&Rover; WIDTH]) -> Rover<Lanes<A>> {
    let mut numbers: Vec<[f64; WIDTH]> = Vec::new();
    for (k, rover) in rovers.iter().enumerate() {
        let mut next = 0;
        level(rover).values(&mut |x| {
            if next == numbers.len() {
                numbers.push([0.0; WIDTH]);
            }
            numbers[next][k] = x;
            next += 1;
        });
    }
    // `map` goes through the parameters in the order of `values`.
    let next = Cell::new(0);
    let mut all = level(rovers[0]).map(&|_| {
        let row = numbers.get(next.replace(next.get() + 1)).copied().unwrap_or_default();
        <Lanes<A> as Plain>::from_lanes(|k| row[k])
    });
    let grounds = rovers.iter().map(|rover| rover.terrain.clone()).collect();
    all.terrain = Terrain::side_by_side(grounds, &|read| Plain::from_lanes(|k| read(&rovers[k].terrain)));
    all
}

/// The same rover on level ground.
fn level(rover: &Rover) -> Rover {
    Rover { terrain: Terrain::default(), ..rover.clone() }
}

impl<A: Arch> Group for SideBySide<A> {
    fn kind(&self) -> &Kind {
        &self.kind
    }

    fn members(&self) -> &[Option<usize>; WIDTH] {
        &self.members
    }

    fn steps_made(&self) -> u64 {
        self.steps_made
    }

    fn join(&mut self, index: usize) -> bool {
        let Some(place) = self.members.iter_mut().find(|member| member.is_none()) else { return false };
        *place = Some(index);
        self.changed = true;
        true
    }

    fn leave(&mut self, index: usize, slot: &mut Slot) {
        let Some(k) = self.members.iter().position(|member| *member == Some(index)) else { return };
        self.let_out(k, slot);
        self.members[k] = None;
        self.changed = true;
    }

    fn step(&mut self, slots: &mut [Slot], steps: u64) {
        let mut movers = self.movers(slots);
        if movers.iter().filter(|moves| **moves).count() < FEWEST {
            return self.advance_one_by_one(slots, movers, steps, false);
        }
        if std::mem::take(&mut self.changed) {
            self.renew(slots);
        }
        let mut left = steps;
        while left > 0 && movers.contains(&true) {
            let (some, changed) = self.decide(slots, &mut movers, left);
            let newly = std::array::from_fn::<_, WIDTH, _>(|k| movers[k] && !self.inside[k]);
            self.let_in(slots, &mut movers);
            self.fill(&movers, slots);
            let changes = A::M::from_lanes(|k| changed[k] && movers[k] && !newly[k]);
            let sound = !changes.any() || self.change_command(slots, &movers, changes);
            let (made, sound) = if sound { self.advance(slots, &mut movers, some) } else { (0, false) };
            self.write_signals();
            for k in 0..WIDTH {
                let Some(slot) = mover(&self.members, slots, &movers, k) else { continue };
                if let Some(simulation) = slot.run.in_joint_coordinates_mut() {
                    self.record(k, simulation, made);
                }
                if sound {
                    slot.run.sense();
                }
            }
            left -= made;
            if !sound {
                return self.advance_one_by_one(slots, movers, left, made == 0);
            }
        }
    }

    fn take_out(&self, index: usize, run: &mut Run) {
        let k = self.members.iter().position(|member| *member == Some(index)).filter(|&k| self.inside[k]);
        if let (Some(k), Some(simulation)) = (k, run.in_joint_coordinates_mut()) {
            self.motion.take_out(k, simulation.places().motion);
        }
    }
}

impl<A: Arch> SideBySide<A> {
    /// Takes new commands over; false where that fails, which leaves everything as it was before.
    fn change_command(&mut self, slots: &mut [Slot], movers: &[bool; WIDTH], changes: A::M) -> bool {
        if self.motion.change_command(&self.rover, &self.command, changes).is_err() {
            return false;
        }
        for k in (0..WIDTH).filter(|&k| changes.lane(k)) {
            let Some(slot) = mover(&self.members, slots, movers, k) else { continue };
            if let Some(simulation) = slot.run.in_joint_coordinates_mut() {
                let command = simulation.places().command;
                self.command.values.iter().zip(&mut command.values).for_each(|(from, to)| *to = from.lane(k));
            }
        }
        if self.lags {
            self.observe(slots, &std::array::from_fn(|k| changes.lane(k)), Recorder::jump);
        }
        true
    }
}
