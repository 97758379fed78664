//! Free bodies thrown against a stop: closed forms of the rebound.

use nlmodes_linalg::{bilinear, sparse_from_triplets};
use nlmodes_model::{Contact, ContactLaw, Dof, DofKind, Drop, MasslessContactModel, Side, StructuralModel};
use nlmodes_timestep::ContactDynamics;

/// Two masses and a massless tip in a row with bending stiffness only, `½ k (q₁ − 2 q₂ + q₃)²`, with a stop at the tip.
struct Body {
    k: f64,
    mass: [f64; 2],
    gap: f64,
    side: Side,
    law: ContactLaw,
}

impl Body {
    fn model(&self) -> MasslessContactModel {
        let bend = [1.0, -2.0, 1.0];
        let stiffness: Vec<_> = (0..9).map(|ij| (ij / 3, ij % 3, self.k * bend[ij / 3] * bend[ij % 3])).collect();
        let mass = [(0, 0, self.mass[0]), (1, 1, self.mass[1])];
        let dofs = (0..3).map(|node| Dof { node, position: node as f64, kind: DofKind::Deflection }).collect();
        let matrix = |entries: &[_]| sparse_from_triplets(3, 3, entries).unwrap();
        let stop = Contact { law: self.law, ..Contact::rigid(2, self.side, self.gap) };
        let model = StructuralModel::new(matrix(&mass), matrix(&stiffness), dofs, vec![stop]).unwrap();
        MasslessContactModel::new(&model, &Drop).unwrap()
    }

    /// Bending and stop stiffness in series, and the frequency at which the masses bounce on it.
    fn in_contact(&self) -> (f64, f64) {
        let k = match self.law {
            ContactLaw::Rigid => self.k,
            ContactLaw::Elastic { stiffness } => self.k * stiffness / (self.k + stiffness),
        };
        (k, (k * (1.0 / self.mass[0] + 4.0 / self.mass[1])).sqrt())
    }
}

/// The free body does not bend and moves uniformly. After the tip makes contact at speed V, the indentation `2 q₂ − q₁
/// − g` is `V/ω sin ωt` and the force `k V/ω sin ωt`; half a period later the tip separates at speed V.
#[test]
fn a_free_body_rebounds_from_a_stop_as_in_the_closed_form() {
    let soft = ContactLaw::Elastic { stiffness: 7.0 };
    for (law, side, scale) in [
        (ContactLaw::Rigid, Side::Positive, 1.0),
        (soft, Side::Positive, 1.0),
        (soft, Side::Negative, 1e-3),
        (ContactLaw::Rigid, Side::Negative, 1e-3),
    ] {
        let body = Body { k: 3.0, mass: [2.0, 0.7], gap: 0.4 * scale, side, law };
        let model = body.model();
        let mut dynamics = ContactDynamics::new(model.clone()).unwrap();
        assert!(dynamics.omega().iter().all(|ω| *ω < 1e-7), "{:?}", dynamics.omega());
        let toward = side.sign() * scale;
        let (q, v) = ([0.3 * toward, 0.1 * toward], [-0.2 * toward, 0.5 * toward]);
        let [tip, speed] = [side.sign() * (2.0 * q[1] - q[0]), side.sign() * (2.0 * v[1] - v[0])];
        let (touch, (k, omega)) = ((body.gap - tip) / speed, body.in_contact());
        let (force, contact) = (k * speed / omega, std::f64::consts::PI / omega);
        let state = dynamics.state(&[q[0], q[1], 0.0], &[v[0], v[1], 0.0]).unwrap();
        let duration = touch + contact + 2.0;
        let trajectory = dynamics.propagate(&state, duration).unwrap();
        let close = |a: f64, b: f64, what: &str| assert!((a - b).abs() < 1e-9 * scale, "{law:?} {what}: {a}, not {b}");
        let energy = 0.5 * bilinear(&[v[0], v[1], 0.0], model.mass(), &[v[0], v[1], 0.0]);
        trajectory.energies().iter().for_each(|e| assert!((e / energy - 1.0).abs() < 1e-12, "{e} of {energy}"));
        let intervals = trajectory.closed_intervals();
        assert_eq!(intervals.len(), 1, "{intervals:?}");
        assert!((intervals[0].from - touch).abs() < 1e-9 && (intervals[0].to - touch - contact).abs() < 1e-9);
        close(trajectory.peak_force(0), force, "force");
        close(trajectory.impulse(0), 2.0 * force / omega, "impulse");
        close(trajectory.contact_periods(1)[0].approach_velocity, speed, "speed of approach");
        for j in 0..=60 {
            let t = duration * f64::from(j) / 60.0;
            let within = (t - touch).clamp(0.0, contact);
            let after = (t - touch - contact).max(0.0);
            // ∫ λ dt and ∫∫ λ dt dt.
            let impulse = force / omega * (1.0 - (omega * within).cos());
            let twice = force / omega * (within - (omega * within).sin() / omega) + impulse * after;
            let pushed = [side.sign() / body.mass[0], -2.0 * side.sign() / body.mass[1]];
            let q = [0, 1].map(|i| q[i] + v[i] * t + pushed[i] * twice);
            let λ = force * (omega * within).sin();
            let found = trajectory.at(t);
            (0..2).for_each(|i| close(found.displacement[i], q[i], "displacement"));
            (0..2).for_each(|i| close(found.velocity[i], v[i] + pushed[i] * impulse, "velocity"));
            close(found.forces[0], λ, "contact force");
            // The tip: K_NN q_N + K_NL q_L = W λ.
            close(found.displacement[2], 2.0 * q[1] - q[0] - side.sign() * λ / body.k, "tip");
        }
    }
}
