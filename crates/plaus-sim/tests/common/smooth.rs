//! An independent integrator, for comparison: balls in contacts that neither open nor change between sticking and
//! sliding.
//!
//! Forces are found from the constraints on accelerations (an index-1 system of differential and algebraic equations,
//! solved by elimination), and the motion by the classical fourth-order method of Runge and Kutta with small steps. It
//! shares nothing with the steps of lasting contact, which solve impulses on velocities.

use glam::DVec3;

#[derive(Clone, Copy)]
pub struct Ball {
    pub x: DVec3,
    pub v: DVec3,
    pub w: DVec3,
    pub mass: f64,
    pub radius: f64,
}

impl Ball {
    fn inertia(&self) -> f64 {
        0.4 * self.mass * self.radius * self.radius
    }
}

#[derive(Clone, Copy)]
pub enum With {
    /// A plane with this normal.
    Plane(DVec3),
    /// The inside of a sphere.
    Bowl { centre: DVec3 },
    /// Another ball, by index.
    Ball(usize),
}

#[derive(Clone, Copy)]
pub enum Friction {
    None,
    /// The touching points do not slip.
    Sticks,
    /// They slip, with this coefficient.
    Slips(f64),
}

#[derive(Clone, Copy)]
pub struct Touch {
    pub a: usize,
    pub with: With,
    pub friction: Friction,
}

/// Accelerations and angular accelerations.
type Rates = Vec<(DVec3, DVec3)>;

pub struct Smooth {
    pub gravity: DVec3,
    pub touches: Vec<Touch>,
}

impl Smooth {
    /// The balls after `time`, in `steps` equal steps.
    pub fn run(&self, balls: &[Ball], time: f64, steps: u32) -> Vec<Ball> {
        let mut now = balls.to_vec();
        let h = time / f64::from(steps);
        for _ in 0..steps {
            let k1 = self.rates(&now);
            let s2 = moved(&now, &now, &k1, 0.5 * h);
            let k2 = self.rates(&s2);
            let s3 = moved(&now, &s2, &k2, 0.5 * h);
            let k3 = self.rates(&s3);
            let s4 = moved(&now, &s3, &k3, h);
            let k4 = self.rates(&s4);
            for i in 0..now.len() {
                let sum = |a: DVec3, b: DVec3, c: DVec3, d: DVec3| (a + (b + c) * 2.0 + d) * (h / 6.0);
                let b = &mut now[i];
                let x = sum(b.v, s2[i].v, s3[i].v, s4[i].v);
                b.v += sum(k1[i].0, k2[i].0, k3[i].0, k4[i].0);
                b.w += sum(k1[i].1, k2[i].1, k3[i].1, k4[i].1);
                b.x += x;
            }
        }
        now
    }

    fn normal(&self, balls: &[Ball], touch: &Touch) -> DVec3 {
        let x = balls[touch.a].x;
        match touch.with {
            With::Plane(n) => n,
            With::Bowl { centre } => (centre - x).normalize(),
            With::Ball(b) => (x - balls[b].x).normalize(),
        }
    }

    /// For the touching points: relative velocity, how fast the normal turns, and the normal acceleration that keeps
    /// them together.
    fn motion(&self, balls: &[Ball], touch: &Touch, n: DVec3) -> (DVec3, DVec3, f64) {
        let a = &balls[touch.a];
        let (v, w, distance) = match touch.with {
            With::Plane(_) => (a.v, a.w * a.radius, f64::INFINITY),
            With::Bowl { centre } => (a.v, a.w * a.radius, -(a.x - centre).length()),
            With::Ball(b) => {
                let b = &balls[b];
                (a.v - b.v, a.w * a.radius + b.w * b.radius, (a.x - b.x).length())
            }
        };
        let turn = (v - n * v.dot(n)) / distance;
        (v - w.cross(n), w.cross(turn), -v.length_squared() / distance)
    }

    /// The accelerations that a force at the touching points causes, without gravity.
    fn response(balls: &[Ball], touch: &Touch, n: DVec3, force: DVec3, rates: &mut Rates) {
        let a = &balls[touch.a];
        rates[touch.a].0 += force / a.mass;
        rates[touch.a].1 += (n * -a.radius).cross(force) / a.inertia();
        if let With::Ball(k) = touch.with {
            let b = &balls[k];
            rates[k].0 -= force / b.mass;
            rates[k].1 += (n * b.radius).cross(-force) / b.inertia();
        }
    }

    /// Rows of the constraints on accelerations: those that `rates` give, minus those that the motion requires if
    /// `asked`.
    fn rows(&self, balls: &[Ball], rates: &Rates, asked: bool) -> Vec<f64> {
        let mut rows = Vec::new();
        for touch in &self.touches {
            let n = self.normal(balls, touch);
            let (_, dragged, needed) = self.motion(balls, touch, n);
            let a = &balls[touch.a];
            let (mut acceleration, mut turning) = (rates[touch.a].0, rates[touch.a].1 * a.radius);
            if let With::Ball(b) = touch.with {
                acceleration -= rates[b].0;
                turning += rates[b].1 * balls[b].radius;
            }
            let asks = if asked { 1.0 } else { 0.0 };
            rows.push(acceleration.dot(n) - asks * needed);
            if matches!(touch.friction, Friction::Sticks) {
                let slip = acceleration - turning.cross(n) - dragged * asks;
                let (s, t) = n.any_orthonormal_pair();
                rows.extend([slip.dot(s), slip.dot(t)]);
            }
        }
        rows
    }

    fn rates(&self, balls: &[Ball]) -> Rates {
        let still = vec![(DVec3::ZERO, DVec3::ZERO); balls.len()];
        // One unknown for a contact that slides or is smooth, three for one that sticks.
        let mut forces: Vec<(usize, DVec3)> = Vec::new();
        for (k, touch) in self.touches.iter().enumerate() {
            let n = self.normal(balls, touch);
            match touch.friction {
                Friction::None => forces.push((k, n)),
                Friction::Slips(mu) => {
                    let slip = self.motion(balls, touch, n).0;
                    forces.push((k, n - (slip - n * slip.dot(n)).normalize() * mu));
                }
                Friction::Sticks => {
                    let (s, t) = n.any_orthonormal_pair();
                    forces.extend([(k, n), (k, s), (k, t)]);
                }
            }
        }
        let falling: Rates = balls.iter().map(|_| (self.gravity, DVec3::ZERO)).collect();
        let free = self.rows(balls, &falling, true);
        let columns: Vec<Vec<f64>> = forces
            .iter()
            .map(|&(k, force)| {
                let mut rates = still.clone();
                let n = self.normal(balls, &self.touches[k]);
                Self::response(balls, &self.touches[k], n, force, &mut rates);
                self.rows(balls, &rates, false)
            })
            .collect();
        let sizes = solve(&columns, &free.iter().map(|r| -r).collect::<Vec<_>>());
        let mut rates = falling;
        for (&(k, force), size) in forces.iter().zip(sizes) {
            let n = self.normal(balls, &self.touches[k]);
            Self::response(balls, &self.touches[k], n, force * size, &mut rates);
        }
        rates
    }
}

fn moved(from: &[Ball], at: &[Ball], rates: &Rates, by: f64) -> Vec<Ball> {
    let step = |((b, s), r): ((&Ball, &Ball), &(DVec3, DVec3))| Ball {
        x: b.x + s.v * by,
        v: b.v + r.0 * by,
        w: b.w + r.1 * by,
        ..*b
    };
    from.iter().zip(at).zip(rates).map(step).collect()
}

/// Elimination with pivots; the matrix is given by columns.
fn solve(columns: &[Vec<f64>], right: &[f64]) -> Vec<f64> {
    let n = right.len();
    let mut rows: Vec<Vec<f64>> = (0..n).map(|i| columns.iter().map(|c| c[i]).chain([right[i]]).collect()).collect();
    for k in 0..n {
        let pivot = (k..n).max_by(|&a, &b| rows[a][k].abs().total_cmp(&rows[b][k].abs())).unwrap();
        rows.swap(k, pivot);
        for i in 0..n {
            if i != k {
                let factor = rows[i][k] / rows[k][k];
                let above = rows[k].clone();
                rows[i].iter_mut().zip(&above).skip(k).for_each(|(x, y)| *x -= factor * y);
            }
        }
    }
    (0..n).map(|k| rows[k][n] / rows[k][k]).collect()
}
