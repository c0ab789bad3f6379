use super::*;
use arm::{Instructions, Kernel};
use proptest::prelude::*;

/// Number that does not fill groups up.
const COUNT: usize = 7;

fn numbers(of: impl Fn(&Rows) -> &Lanes, family: &Inequalities) -> Vec<f64> {
    let all = family.groups.iter().flat_map(|rows| *of(rows));
    all.take(COUNT).collect()
}

/// The equations of the module's head, linearised.
fn assert_solved(family: &Inequalities, changes: &[Lanes], mu: [&[f64]; 2]) {
    let of = |of: fn(&Rows) -> &Lanes| numbers(of, family);
    let (c, s, t) = (of(|r| &r.value), of(|r| &r.slack), of(|r| &r.excess));
    let (ds, dt) = (of(|r| &r.slack_step), of(|r| &r.excess_step));
    let (lambda, step) = (of(|r| &r.multiplier), of(|r| &r.multiplier_step));
    for i in family.lost..COUNT {
        let row = c[i] + family.sign * changes.as_flattened()[i] + (s[i] + ds[i]) - (t[i] + dt[i]);
        assert!(row.abs() < 1e-9, "{row}");
        let product = lambda[i] * ds[i] + s[i] * step[i] + lambda[i] * s[i] - mu[0][i];
        assert!(product.abs() < 1e-9, "{product}");
        if family.elastic() {
            let nu = family.price - lambda[i];
            let product = nu * dt[i] - t[i] * step[i] + nu * t[i] - mu[1][i];
            assert!(product.abs() < 1e-9, "{product}");
        }
    }
    let idle = [s, t, lambda].into_iter().zip([ds, dt, step]);
    for (of, step) in idle {
        assert!(of[..family.lost].iter().all(|x| x.is_finite()));
        assert!(step[..family.lost].iter().all(|&x| x == 0.0));
    }
}

/// A predictor and a corrector, with all that is promised of them.
struct Iteration {
    family: Inequalities,
    quantities: Vec<f64>,
    changes: [Lanes; 2],
    mu: f64,
}

impl Kernel for Iteration {
    type Output = ();

    #[inline(always)]
    fn run<A: Arithmetic>(self) {
        let Self {
            mut family,
            quantities,
            changes,
            mu,
        } = self;
        family.evaluate::<A>(&quantities);
        family.start::<A>(mu, 0.1, None);
        let before = family.measure::<A>();
        assert!((before.gap - mu * family.products()).abs() < 1e-9);
        family.predict::<A>();
        let mut rates = [A::Vector::splat(0.0); 2];
        family.step::<A>(Aim::ZERO, &changes, &mut rates);
        assert_solved(&family, &changes, [&[0.0; COUNT], &[0.0; COUNT]]);

        // The nearer to the boundary the smaller the products, within 1e-4 and 5e-3 of the way.
        let fast = A::Vector::splat(2.0);
        let left = |mu: f64| 1.0 - 2.0 * length(fast, mu);
        assert!((left(0.0) - 1e-4).abs() < 1e-12 && (left(1e9) - 5e-3).abs() < 1e-12);
        assert!(left(mu) >= left(0.1 * mu) && left(1e-3 * mu) <= 5e-3 + 1e-12);

        // Whatever the step, what must be positive stays so.
        let [primal, dual] = [length(rates[0], 0.0), length(rates[1], 0.0)];
        let mut after = family.clone();
        after.advance::<A>(primal);
        for rows in &mut after.groups {
            for l in 0..LANES {
                rows.multiplier[l] += dual * rows.multiplier_step[l];
            }
        }
        for rows in &after.groups {
            for l in (0..LANES).filter(|&l| rows.open[l] > 0.0) {
                let lambda = rows.multiplier[l];
                assert!(rows.slack[l] > 0.0 && lambda > 0.0 && lambda < family.price);
                assert!(!family.elastic() || rows.excess[l] > 0.0);
            }
        }
        let gap = family.gap_after::<A>(primal, dual);
        assert!((gap - after.measure::<A>().gap).abs() < 1e-12);

        let aim = Aim {
            mu: 0.1 * mu,
            correction: 1.0,
        };
        let products = |steps: Vec<f64>, sign: f64| -> Vec<f64> {
            let multiplier_steps = numbers(|rows| &rows.multiplier_step, &family);
            let pairs = steps.iter().zip(&multiplier_steps);
            pairs.map(|(a, b)| aim.mu + sign * a * b).collect()
        };
        let expected = [
            products(numbers(|rows| &rows.slack_step, &family), -1.0),
            products(numbers(|rows| &rows.excess_step, &family), 1.0),
        ];
        family.correct::<A>(aim);
        let slopes = numbers(|rows| &rows.slope, &family);
        family.step::<A>(aim, &changes, &mut rates);
        assert_solved(&family, &changes, [&expected[0], &expected[1]]);
        // The slope is what the multiplier would be without a change of c.
        let steps = numbers(|rows| &rows.multiplier_step, &family);
        let weights = numbers(|rows| &rows.weight, &family);
        let multipliers = numbers(|rows| &rows.multiplier, &family);
        for i in 0..COUNT {
            let of_change = weights[i] * family.sign * changes.as_flattened()[i];
            let expected = multipliers[i] + steps[i] - of_change;
            assert!((slopes[i] - expected).abs() < 1e-9);
        }
    }
}

proptest! {
    #[test]
    fn steps_solve_the_linearised_equations(
        quantities in prop::collection::vec(-2.0..2.0_f64, COUNT),
        changes in prop::array::uniform2(prop::array::uniform4(-1.0..1.0_f64)), mu in 1e-3..0.5_f64,
        elastic: bool, lost in 0..COUNT, sign in prop_oneof![Just(1.0), Just(-1.0)], fused: bool,
    ) {
        let mut family = Inequalities::new(COUNT, if elastic { 10.0 } else { f64::INFINITY }, sign);
        family.lost = if elastic { lost } else { 0 };
        family.set_bounds((0..COUNT).map(|k| 0.1 * k as f64));
        let instructions = if fused { Instructions::Fused } else { Instructions::Baseline };
        instructions.run(Iteration { family, quantities, changes, mu });
    }

    /// Rows that matter get their multipliers, all others the room there is.
    #[test]
    fn a_start_believes_its_guesses(
        quantities in prop::collection::vec(-2.0..2.0_f64, COUNT),
        guesses in prop::collection::vec(
            prop_oneof![Just(0.0), Just(-0.0), Just(f64::NAN), -8.0..0.0, 1e-12..1e-6, 1e-6..8.0], COUNT,
        ),
        elastic: bool, mu in 1e-6..1e-2_f64,
    ) {
        let least = 0.1;
        let mut family = Inequalities::new(COUNT, if elastic { 10.0 } else { f64::INFINITY }, 1.0);
        family.evaluate::<arm::Separate>(&quantities);
        let halves: Vec<f64> = guesses.iter().map(|guess| 0.5 * guess).collect();
        family.start::<arm::Separate>(mu, least, Some((&halves, 2.0)));
        let of = |of: fn(&Rows) -> &Lanes| numbers(of, &family);
        let (s, t, lambda) = (of(|r| &r.slack), of(|r| &r.excess), of(|r| &r.multiplier));
        for i in 0..COUNT {
            let (c, guess) = (quantities[i], guesses[i]);
            prop_assert!(s[i] > 0.0 && lambda[i] > 0.0 && lambda[i] * s[i] <= mu * (1.0 + 1e-12));
            prop_assert!(!elastic || ((10.0 - lambda[i]) * t[i] - mu).abs() < 1e-12);
            if -c >= least {
                prop_assert_eq!(s[i], -c);
            } else {
                prop_assert!(s[i] <= least);
            }
            if guess * least > mu && -c * guess < mu {
                prop_assert!((lambda[i] - guess).abs() < 1e-12 * guess);
            }
            prop_assert!(guess.is_nan() || lambda[i] <= guess.max(1e-9) * (1.0 + 1e-12));
        }
    }

    #[test]
    fn a_restart_is_central(
        quantities in prop::collection::vec(-9.0..9.0_f64, COUNT), elastic: bool, mu in 1e-3..1e2_f64,
    ) {
        let price = if elastic { 10.0 } else { f64::INFINITY };
        let mut family = Inequalities::new(COUNT, price, 1.0);
        family.evaluate::<arm::Separate>(&quantities);
        family.start::<arm::Separate>(0.3, 0.1, None);
        family.restart(mu, 0.1);
        let measure = family.measure::<arm::Separate>();
        prop_assert!((measure.gap - mu * family.products()).abs() < 1e-8 * measure.gap);
        prop_assert!(!elastic || measure.residual < 1e-12);
        let of = |of: fn(&Rows) -> &Lanes| numbers(of, &family);
        let (s, t, lambda) = (of(|r| &r.slack), of(|r| &r.excess), of(|r| &r.multiplier));
        for i in 0..COUNT {
            prop_assert!(s[i] > 0.0 && lambda[i] > 0.0 && lambda[i] < price);
            prop_assert!((lambda[i] * s[i] - mu).abs() < 1e-9 * mu.max(1.0));
            // Without a price nothing but bounds that are near or broken leaves a residual.
            prop_assert!(elastic || s[i] == f64::max(-quantities[i], 0.1));
            prop_assert!(!elastic || ((price - lambda[i]) * t[i] - mu).abs() < 1e-9 * mu.max(1.0));
        }
    }

    /// Sums and the merit over a family that is not whole groups, one part of it lost.
    #[test]
    fn the_merit_is_its_definition(
        quantities in prop::collection::vec(-2.0..2.0_f64, COUNT), elastic: bool, lost in 0..COUNT,
        change in -1.0..1.0_f64,
    ) {
        let mut family = Inequalities::new(COUNT, if elastic { 10.0 } else { f64::INFINITY }, 1.0);
        family.lost = if elastic { lost } else { 0 };
        family.evaluate::<arm::Separate>(&quantities);
        family.start::<arm::Separate>(0.3, 0.1, None);
        for rows in &mut family.groups {
            for l in (0..LANES).filter(|&l| rows.open[l] > 0.0) {
                rows.slack[l] += 0.3;
                // Some too small to be worth their residuals.
                rows.multiplier[l] *= [1.0, 1e-7][l % 2];
            }
        }
        family.predict::<arm::Separate>();
        let mut rates = [<arm::Separate as Arithmetic>::Vector::splat(0.0); 2];
        let changes = vec![[change; LANES]; COUNT.div_ceil(LANES)];
        family.step::<arm::Separate>(Aim::ZERO, &changes, &mut rates);
        let measure = family.measure::<arm::Separate>();
        let (s, t) = (numbers(|rows| &rows.slack, &family), numbers(|rows| &rows.excess, &family));
        let lambda = numbers(|rows| &rows.multiplier, &family);
        let dual = numbers(|rows| &rows.multiplier_step, &family);
        let lambda: Vec<f64> = lambda.iter().zip(&dual).map(|(l, d)| l.max(l + d)).collect();
        let steepest = lambda.iter().copied().fold(0.0, f64::max);
        let (mut merit, mut most) = (0.0, 0.0_f64);
        for i in 0..COUNT {
            let c = quantities[i];
            if i < family.lost {
                merit += family.price * c;
                continue;
            }
            let residual = (c + s[i] - t[i]).abs();
            most = most.max(residual);
            merit += 1.1 * lambda[i].max(1e-4 * steepest) * residual - 0.2 * s[i].ln();
            if elastic {
                merit += family.price * t[i] - 0.2 * t[i].ln();
            }
        }
        prop_assert!((measure.price_and_barrier(0.2) + family.residual_penalty::<arm::Separate>() - merit).abs() < 1e-9);
        prop_assert!((measure.residual - most).abs() < 1e-12);
        // Of two families the sums are sums, and the largest the larger.
        let both = measure.and(measure);
        prop_assert!((both.price_and_barrier(0.2) - 2.0 * measure.price_and_barrier(0.2)).abs() < 1e-9);
        prop_assert_eq!((both.gap, both.residual), (2.0 * measure.gap, measure.residual));
    }
}
