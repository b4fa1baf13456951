//! The thesis's closed forms for linear stresses (2.10-2.23, B.1-B.7).
