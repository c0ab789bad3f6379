use identification::*;
fn main() {
    let mut a = std::env::args().skip(1);
    let load = |f: &str| {
        let text = std::fs::read_to_string(f).unwrap();
        let mut l = text.lines();
        let h: Vec<&str> = l.next().unwrap().split(',').collect();
        let i = |n: &str| h.iter().position(|c| *c == n).unwrap();
        let (ia, it) = (i("plant.angle"), i("controller.torque"));
        let (mut th, mut ta) = (vec![], vec![]);
        for line in l {
            let c: Vec<&str> = line.split(',').collect();
            th.push(c[ia].parse().unwrap());
            ta.push(c[it].parse().unwrap());
        }
        Measurement::new(2.5e-4, th[8000..].to_vec(), ta[8000..].to_vec())
    };
    let m = load(&a.next().unwrap());
    let v = load(&a.next().unwrap());
    let mut s = Settings::default();
    if let Some(x) = a.next() {
        if x == "paper" {
            s.order = regression::Order::Signals
        } else {
            s.harmonics = Some(x.parse().unwrap())
        }
    }
    let t = std::time::Instant::now();
    let r = identify(&m, &s).unwrap();
    println!("time {:?}", t.elapsed());
    let tp = arm::Parameters::tflex();
    for e in &r.estimates {
        let truth = match e.name.as_str() {
            "arm.inertia" => tp.inertia,
            "arm.damping" => tp.damping,
            "arm.stiffness" => tp.stiffness,
            "arm.offset" => tp.offset,
            "arm.hysteresis" => tp.hysteresis,
            "arm.cogging_frequency" => tp.cogging_frequency,
            n => {
                let i: usize = n[n.len() - 2..n.len() - 1].parse().unwrap();
                if n.contains("cos") {
                    tp.cogging_cos[i - 1]
                } else {
                    tp.cogging_sin[i - 1]
                }
            }
        };
        println!(
            "{:24} {:12.6} true {:10.5} err {:8.4}% sigma {:.2e} z {:6.2} torque {:.4} {}",
            e.name,
            e.value,
            truth,
            100.0 * (e.value - truth) / truth,
            e.sigma,
            (e.value - truth) / e.sigma,
            e.torque,
            e.identifiable
        );
    }
    for c in &r.candidates {
        println!("{c:?}");
    }
    println!(
        "{:?} cond {} curve {} H {} {:?}",
        r.fit, r.condition, r.residual_of_any_curve, r.harmonics, r.warnings
    );
    let sv = Series::new(&r.parameters, &s.regression(&v).unwrap());
    println!("validation {:?}", sv.fit());
}
