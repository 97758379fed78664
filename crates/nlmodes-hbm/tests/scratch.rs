mod support;
use nlmodes_continuation::*;
use nlmodes_hbm::*;
use std::ops::ControlFlow;
use support::*;

#[test]
fn scratch() {
    let h: usize = std::env::var("NH").map(|v| v.parse().unwrap()).unwrap_or(1);
    let s = if std::env::var("TWO").is_ok() { two_element_rod() } else { paper_rod() };
    let (mut p, start) = problem(&s, 1, h, Symmetry::Even, Switching::Exact);
    println!("omega {} Hz E {:e} contact {}", start.omega / 6.283185307179586, start.energy, start.contact);
    let n = p.dim();
    let x = start.unknowns(p.series(), n);
    let t = start.direction(p.series(), n);
    let i = p.frequency_index();
    let emax: f64 = std::env::var("EMAX").map(|v| v.parse().unwrap()).unwrap_or(20.0);
    let c = Continuation { bounds: vec![Bound { coordinate: n, min: -5.0, max: emax.ln() }, Bound{coordinate:i,min:0.8,max:1.5}], watched: vec![i], max_points: 2000, ..Default::default() };
    let t0 = std::time::Instant::now();
    let b = c.run(&mut p, &x, 0.0, &t, |_| ControlFlow::Continue(())).unwrap();
    println!("{} points {:?} {} evals {} refused {:?}", b.points.len(), b.stop, b.evaluations, b.refused_steps, t0.elapsed());
    let full = std::env::var("FULL").is_ok();
    for (k, q) in b.points.iter().enumerate() {
        if full || !q.events.is_empty() || k + 3 > b.points.len() || k % 50 == 0 {
            println!("{k} f {:.9} E/Eg {:.9} b {:?} res {:.1e} it {} ev {:?}", q.x[i] * start.omega / 6.283185307179586, q.p.exp(), &q.x[..i.min(4)], q.residual, q.iterations, q.events);
        }
    }
    let m = p.modal_point(&b.points.last().unwrap().x, 0.0).unwrap();
    println!("last: E {} Etot {} q~ {} peak {} frac {} int {} force {}", m.kinetic_energy, m.total_energy, m.modal_amplitude, m.peak, m.contact_fraction, m.contact_intervals, m.peak_contact_force);
}
