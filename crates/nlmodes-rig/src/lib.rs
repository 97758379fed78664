//! Virtual test rig: a vibrating structure with a stop, a shaker, sensors and a level schedule.
