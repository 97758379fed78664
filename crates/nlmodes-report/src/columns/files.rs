use super::{
    AppropriationRow, BranchRow, Column, ContactRow, DecayRow, DifferenceRow, FileMeaning, FollowRow, GRADIENT_COLUMNS,
    HarmonicDampingRow, ModalPointRow, ParticipationRow, ResponseDifferenceRow, ResponseRow, Row, StopDifferenceRow,
    TouchRow,
};
use crate::table::{HARMONIC_ARRAYS, HISTORY_ARRAYS, MATLAB_VARIABLES, START_ARRAYS, TRANSIENT_ARRAYS};

/// The results files of a structure, in order of usefulness.
pub const FILES: [FileMeaning; 30] = [
    FileMeaning {
        name: "branch.csv",
        meaning: "The branch, one row per point, written as points are found; other branches of a run have \
            folders of their own",
        columns: &[BranchRow::COLUMNS],
    },
    FileMeaning {
        name: "branch.csv of responses",
        meaning: "For a scene with responses, the points of all its curves: the columns above, with the frequency of \
            the load in `frequency_hz` and the amplitude of stop 0 at that frequency in `fundamental_m`, and these",
        columns: &[ResponseRow::COLUMNS],
    },
    FileMeaning {
        name: "branch.csv with gradients",
        meaning: "For a scene with `[[sensitivity]]`, behind the columns above and for each parameter those of these \
            that its points have; of modes written at the end of the run",
        columns: &[&GRADIENT_COLUMNS],
    },
    FileMeaning {
        name: "appropriation.csv",
        meaning: "For responses of kind \"appropriation\", the forces that bring the damped structure into its mode, \
            one row per point, drive point and harmonic; for a test with several controlled harmonics the measured \
            ones, one row per level and harmonic",
        columns: &[AppropriationRow::COLUMNS],
    },
    FileMeaning {
        name: "contacts.csv",
        meaning: "The stops, one row per point and stop",
        columns: &[ContactRow::COLUMNS],
    },
    FileMeaning {
        name: "harmonics.npz",
        meaning: "The motions as complex Fourier coefficients, for NumPy (P points, D recorded degrees of freedom, H \
            harmonics)",
        columns: &[&HARMONIC_ARRAYS],
    },
    FileMeaning {
        name: "histories.npz",
        meaning: "Motion and force of the contacts over a period, for the points that figures show, of responses the \
            one with the largest contact force of each curve, and those of `output.histories` (P points, C contacts, T \
            instants)",
        columns: &[&HISTORY_ARRAYS],
    },
    FileMeaning {
        name: "results.mat",
        meaning: "With `output.matlab = true`: branch, stops, motions and histories for MATLAB and Octave (version 5)",
        columns: &[&MATLAB_VARIABLES],
    },
    FileMeaning {
        name: "participation.csv",
        meaning: "Participation of the lowest linear modes, one row per point",
        columns: &[ParticipationRow::COLUMNS],
    },
    FileMeaning {
        name: "modal_points.csv",
        meaning: "For records and virtual tests, one row per record or level; what a record does not give is empty",
        columns: &[ModalPointRow::COLUMNS],
    },
    FileMeaning {
        name: "damping_by_harmonic.csv",
        meaning: "For records with linear modes, the damping of each harmonic, one row per record and harmonic",
        columns: &[HarmonicDampingRow::COLUMNS],
    },
    FileMeaning {
        name: "decay.csv",
        meaning: "For records with `[free_decay]`, the points of the decays, one row per block of three periods",
        columns: &[DecayRow::COLUMNS],
    },
    FileMeaning {
        name: "design.json",
        meaning: "From `experiment design`: places for the exciter, settings of the loop, of each level whether it is \
            held and the largest reading of each channel, ranges for the sensors",
        columns: &[],
    },
    FileMeaning {
        name: "backbone.csv",
        meaning: "For virtual tests, the computed curve that is laid under the points, with the columns of \
            `branch.csv`; `backbone_ms-hbm.csv`, `backbone_damped-mode.csv` and `backbone_phase-resonance.csv` beside \
            it where these are asked for",
        columns: &[],
    },
    FileMeaning {
        name: "overlay.csv",
        meaning: "With `[[overlay]]`: its points against the first branch at equal modal amplitude, or equal energy \
            where they have no amplitude",
        columns: &[DifferenceRow::COLUMNS],
    },
    FileMeaning {
        name: "response_overlay.csv",
        meaning: "With `[[overlay]]` beside responses: its points against the curve over the frequency that is nearest \
            at the same frequency, of the same level where the point has one",
        columns: &[ResponseDifferenceRow::COLUMNS],
    },
    FileMeaning {
        name: "methods.csv",
        meaning: "Where a scene has several methods or numbers of harmonics: each point of the others against the \
            first one at equal modal amplitude",
        columns: &[DifferenceRow::COLUMNS],
    },
    FileMeaning {
        name: "methods_stops.csv",
        meaning: "The same stop by stop: the impulse of each at equal modal amplitude, or energy, and at equal \
            frequency; `overlay_stops.csv` where a branch with `contacts.csv` is laid over",
        columns: &[StopDifferenceRow::COLUMNS],
    },
    FileMeaning {
        name: "starts.npz",
        meaning: "With `method.kind = \"shooting\"`: the states from which the exact motions start at rest (P points, \
            D degrees of freedom)",
        columns: &[&START_ARRAYS],
    },
    FileMeaning {
        name: "transient.npz",
        meaning: "For a scene with `[transient]`, the histories at equal distances in time (P places, the contacts \
            behind them; C contacts, T instants, W windows, F frequencies)",
        columns: &[&TRANSIENT_ARRAYS],
    },
    FileMeaning {
        name: "touches.csv",
        meaning: "For a scene with `[transient]`, one row per touch, in the order in which they end",
        columns: &[TouchRow::COLUMNS],
    },
    FileMeaning {
        name: "settled.json",
        meaning: "From `nlmodes-cli settle`: `kind`, what the motion of a point of a response becomes, disturbed along \
            the vector of its largest multiplier (`periodic` with `periods` of the load in one of the motion, \
            `two-lines` with both `frequencies_hz`, `irregular` with the largest values and their spread, `other` \
            with where it went), the disturbance, the time that was integrated, and of the exact motion next to the \
            point its distance and largest multiplier; without these two none was found, and the state of the point \
            itself was followed",
        columns: &[],
    },
    FileMeaning {
        name: "follow.csv",
        meaning: "Of `nlmodes-cli follow`: folds, first touches, a phase resonance or a mode at an energy over a \
            parameter, a row a point; \
            `follow.json` has the key, and why each curve ends, `follow_….svg` are its figures",
        columns: &[FollowRow::COLUMNS],
    },
    FileMeaning {
        name: "summary.json",
        meaning: "The scene as read, linear frequencies, grazing point, method, `reduction` (free-interface modes, \
            and by how much half as many change the frequency), `contacts` of a structure from files (nodes, normal, \
            gap of each number), `rest` of a structure under static loads or before stops that press (gap of each \
            stop while all are open, whether it is closed at rest, clearance, force), `stress_left_out` (why there is \
            no stress, where only the size of a structure prevents it), `motion` (the point that `motion.pvd` \
            shows), events, internal resonances, stability, why the branch ended, times; of responses the same of \
            each curve; under `errors` the estimated error of each number with its largest source and \
            what makes it smaller, under `certificate` what was compared",
        columns: &[],
    },
    FileMeaning {
        name: "report.html",
        meaning: "Everything on one page that needs no network; left out with `output.page = false`",
        columns: &[],
    },
    FileMeaning {
        name: "frequency_energy.svg",
        meaning: "Figures, also `frequency_amplitude.svg`, `contacts.svg`, `participation.svg`, `motion_….svg`, \
            with `[[sensitivity]]` `gradients_….svg`, `history_P….svg`; of responses `responses.svg` and others \
            instead of the first two, of motions in time `envelope.svg` and `spectrum.svg`, and motions, contacts \
            and histories of the curve of the first response with the largest contact force, up to that; left out \
            with `output.figures = false`",
        columns: &[],
    },
    FileMeaning {
        name: "motion.pvd",
        meaning: "For ParaView, of a structure from files whose mesh is known: one period with frames `motion_….vtu` \
            (24 equidistant ones, and those where each contact begins, is largest and ends), number of the node, \
            displacement in m (NaN where it depends on other nodes), contact_force in N, gap in m, \
            and where contacts cover faces of the mesh contact_pressure in Pa (with nodes in the middle of edges it is \
            larger there than at corners, as the forces of nodes are); where stress is recovered, stress, von_mises \
            and principal_stress in Pa",
        columns: &[],
    },
    FileMeaning {
        name: "run.json",
        meaning: "The scene to which the results belong, and the folder from which its relative files count",
        columns: &[],
    },
    FileMeaning { name: "steps.jsonl", meaning: "The steps, from which `run --resume` continues", columns: &[] },
    FileMeaning {
        name: "branch_…/",
        meaning: "Further branches of a run that follows all half-branches of its branch points, with the same tables",
        columns: &[&[] as &[Column]],
    },
];
