//! Periods of a record to a point of a nonlinear mode: frequency, shape, damping, power-based mode indicator.
