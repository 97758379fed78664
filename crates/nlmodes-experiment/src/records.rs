//! Records of a test: channels with quantity, unit, role and position, read from and written to files.
