//! Damped and forced motions of several structures, each with its own damping, loads and places.

use nlmodes::response::ResponsePoint;
use nlmodes_run::{Over, Silent};
use nlmodes_scene::parse;

/// A rod with what else is written under its heading.
fn rod(heading: &str, length: f64, ends: [&str; 2], more: &str) -> String {
    format!(
        "{heading}\nkind = \"rod\"\nlength_m = {length}\nelements = 8\nstart = \"{}\"\nend = \"{}\"\n\
         material = {{ youngs_modulus_pa = 210e9, density_kg_m3 = 7800.0 }}\nsection = {{ area_m2 = 1e-4 }}\n{more}\n",
        ends[0], ends[1]
    )
}

/// Two rods whose free ends face each other at a distance.
fn facing(second: f64, gap: f64, own: [&str; 2]) -> String {
    let first = rod("[[structure]]", 1.0, ["clamped", "free"], own[0]);
    let second = rod("[[structure]]", second, ["free", "clamped"], own[1]);
    format!(
        "{first}{second}[[contact]]\nstructure = 1\nat_m = 1.0\ndirection = \"axial\"\nside = \"positive\"\ngap_m = \
            {gap}\n\
         against = {{ structure = 2, at_m = 0.0 }}\n"
    )
}

/// One of them before a wall.
fn before_wall(gap: f64) -> String {
    let rod = rod("[structure]", 1.0, ["clamped", "free"], "");
    format!("{rod}[[contact]]\nat_m = 1.0\ndirection = \"axial\"\nside = \"positive\"\ngap_m = {gap}\n")
}

/// The points of the only curve of a scene with so many open modes.
fn curve(structure: &str, rest: &str, modes: usize) -> Vec<ResponsePoint> {
    let place = tempfile::tempdir().unwrap();
    let text = format!(
        "{structure}{rest}[method]\nharmonics = 7\n[reduction]\nkind = \"open-modes\"\nmodes = {modes}\n\
         [output]\nstability = \"never\"\nfigures = false\npage = false\n"
    );
    let mut file = parse("scene.toml", &text, &[]).unwrap_or_else(|refused| panic!("{}", refused.text(false)));
    file.scene.output_directory = place.path().join("out");
    let outcome = nlmodes_run::responses::run(&file, Over::Same, &mut Silent).unwrap();
    assert!(outcome.is_complete(), "{:?}", outcome.curves[0].said());
    outcome.curves[0].motions.as_ref().unwrap().points.clone()
}

fn over_force(hz: f64, level: f64) -> String {
    format!("[[response]]\nkind = \"force\"\nfrequency_hz = {hz}\nlevels_n = [{level}]\n")
}

#[test]
fn two_rods_that_are_driven_against_each_other_are_one_before_a_wall() {
    for (gap, level, hz) in [(1e-4, 150.0, 1297.0), (3e-6, 5.0, 1305.0)] {
        let load = "[damping]\nratio = 0.01\n[[force]]\nat_m = 0.5\n";
        let one = curve(&before_wall(gap), &format!("{load}{}", over_force(hz, level)), 6);
        let load = "[damping]\nratio = 0.01\n[[force]]\nstructure = 1\nat_m = 0.5\n[[force]]\nstructure = 2\nat_m = \
            0.5\namplitude_n = -1\n";
        let two = curve(&facing(1.0, 2.0 * gap, ["", ""]), &format!("{load}{}", over_force(hz, level)), 12);
        // Both curves end at the level.
        let (one, two) = (one.last().unwrap(), two.last().unwrap());
        let (a, b) = (&one.motion, &two.motion);
        assert!(a.contacts[0].closed_share > 0.05, "{:?}", a.contacts[0]);
        let close = |what: &str, one: f64, two: f64| {
            assert!((one - two).abs() < 1e-9 * one.abs(), "{what}: {one:e} of one, {two:e} of two");
        };
        close("drive", one.drive.norm(), two.drive.norm());
        close("mean force", a.contacts[0].mean_force, b.contacts[0].mean_force);
        close("peak force", a.contacts[0].peak_force, b.contacts[0].peak_force);
        close("input power", 2.0 * a.input_power, b.input_power);
        close("energy", 2.0 * a.total_energy, b.total_energy);
    }
}

#[test]
fn each_structure_has_its_own_damping_also_where_their_modes_coincide() {
    let own = ["damping = { ratio = 0.01 }", "damping = { ratios = [0.03, 0.002, 0.05] }"];
    let alone = ["[damping]\nratio = 0.01\n", "[damping]\nratios = [0.03, 0.002, 0.05]\n"];
    // Near the first three resonances, far from contact; of other lengths, too, so that the modes differ.
    for ((hz, second), number) in [1297.0, 3900.0, 6550.0].map(|hz| (hz, 1.0)).into_iter().zip([2, 1, 2]) {
        let force = |named: &str| format!("[[force]]\n{named}at_m = 0.5\n{}", over_force(hz, 1.0));
        let single = curve(&before_wall(1.0), &format!("{}{}", alone[number - 1], force("")), 6);
        let pair = curve(&facing(second, 1.0, own), &force(&format!("structure = {number}\n")), 12);
        let [single, pair] = [single, pair].map(|points| points.last().unwrap().drive);
        assert!((single - pair).norm() < 1e-9 * single.norm(), "{hz} Hz, structure {number}: {single} alone, {pair}");
    }
}

#[test]
fn power_that_goes_in_at_one_structure_is_lost_in_both() {
    let structures = facing(1.3, 1.5e-4, ["", "damping = { rayleigh = { mass_1_s = 20.0, stiffness_s = 1e-7 } }"]);
    let load = "[damping]\nratio = 0.005\n[[damping.dashpot]]\nstructure = 2\nat_m = 0.3\ndamping_n_s_m = 15.0\n\
                [[force]]\nstructure = 1\nat_m = 0.6\n\
                [[response]]\nkind = \"frequency\"\nfrequency_hz = [1250.0, 1400.0]\nlevels_n = [60.0]\n";
    let points = curve(&structures, load, 12);
    assert!(points.iter().any(|point| point.motion.contacts[0].closed_share > 0.02), "no point touches");
    let largest = points.iter().map(|point| point.motion.input_power).fold(0.0, f64::max);
    for point in &points {
        let (input, lost) = (point.motion.input_power, point.motion.dissipated_power);
        assert!(input > 0.0 && (input - lost).abs() < 1e-9 * largest, "{input:e} W in, {lost:e} W lost");
    }
}

#[test]
fn a_base_shakes_all_structures() {
    // Each far from the other moves as it does alone; the acceleration is that of one base.
    let shakes = "[damping]\nratio = 0.02\n[base_motion]\nacceleration_m_s2 = 3.0\n[[response]]\nkind \
        = \"force\"\nfrequency_hz = 1200.0\nlevels_m_s2 = [3.0]\n";
    let alone = curve(&before_wall(1.0), &format!("{shakes}drive_m = 0.5\n"), 6);
    for number in [1, 2] {
        let named = format!("{shakes}drive_m = 0.5\ndrive_structure = {number}\n");
        let pair = curve(&facing(1.0, 1.0, ["", ""]), &named, 12);
        let [one, other] = [&alone, &pair].map(|points| points.last().unwrap().drive);
        assert!((one - other).norm() < 1e-9 * one.norm(), "structure {number}: {one} alone, {other}");
    }
}
