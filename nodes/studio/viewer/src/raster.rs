//! Spheres and lines in parallel projection, by a depth buffer. The same input gives the same pixels on every machine: only
//! additions, multiplications, divisions and square roots.

use crate::palette::Colour;
use grainlab_core::Vec3;

/// Samples of a pixel along each side.
const SAMPLES: usize = 2;

/// Towards the viewer, as in the page: from the right, the front and above.
const VIEWER: [f64; 3] = [2.55, -2.15, 1.45];

/// Towards the light, in the frame of the picture: from the upper left.
const LIGHT: [f64; 3] = [-0.45, 0.7, 0.75];

/// Numbers of things that are not spheres.
const NOTHING: u32 = u32::MAX;
const LINE: u32 = u32::MAX - 1;

/// Colour of lines.
const OUTLINE: Colour = [138, 138, 150];

/// Directions in which the depth of a neighbourhood is sampled, and share of its radius.
const AROUND: [[f64; 2]; 12] = [
    [0.25, 0.0],
    [-0.15, 0.35],
    [-0.2, -0.3],
    [0.35, -0.45],
    [0.45, 0.45],
    [-0.6, 0.1],
    [0.0, -0.7],
    [0.1, 0.75],
    [0.8, 0.1],
    [-0.65, -0.6],
    [-0.6, 0.65],
    [0.65, -0.65],
];

/// A sphere in metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sphere {
    pub(crate) centre: Vec3,
    pub(crate) radius: f64,
    pub(crate) colour: Colour,
}

/// Right, up and towards the viewer.
fn frame() -> [Vec3; 3] {
    let toward = Vec3::from(VIEWER).normalize();
    let right = Vec3::z().cross(&toward).normalize();
    [right, toward.cross(&right), toward]
}

/// A scene in the frame of the picture, pixels.
struct Scene {
    spheres: Vec<([f64; 3], f64)>,
    lines: Vec<[[f64; 3]; 2]>,
    size: [usize; 2],
}

/// Draws spheres and lines into a picture of this width and height, as red, green, blue and opacity. `fill` is the largest
/// part of the picture that they cover along a side.
pub(crate) fn draw(
    spheres: &[Sphere],
    lines: &[[Vec3; 2]],
    [width, height]: [usize; 2],
    fill: f64,
) -> Vec<u8> {
    let scene = placed(spheres, lines, [width * SAMPLES, height * SAMPLES], fill);
    let (depth, owner) = visible(&scene);
    let mut pixels = vec![0u8; 4 * width * height];
    let behind = depth.iter().copied().filter(|d| d.is_finite()).fold(f32::INFINITY, f32::min);
    let front = depth.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    for (n, pixel) in pixels.chunks_exact_mut(4).enumerate() {
        let (x, y) = (n % width * SAMPLES, n / width * SAMPLES);
        let (mut sum, mut hits) = ([0.0; 3], 0.0);
        for (dx, dy) in (0..SAMPLES * SAMPLES).map(|s| (s % SAMPLES, s / SAMPLES)) {
            let at = (y + dy) * scene.size[0] + x + dx;
            let colour = match owner[at] {
                NOTHING => continue,
                LINE => OUTLINE.map(f64::from),
                grain => {
                    let far = f64::from((front - depth[at]) / (front - behind).max(1.0));
                    let open = openness(&scene, &depth, [x + dx, y + dy], scene.spheres[grain as usize].1);
                    shaded(&scene, &spheres[grain as usize], grain, [x + dx, y + dy], open, far)
                }
            };
            sum = std::array::from_fn(|c| sum[c] + colour[c]);
            hits += 1.0;
        }
        if hits > 0.0 {
            pixel[..3].copy_from_slice(&sum.map(|v| (v / hits).round().clamp(0.0, 255.0) as u8));
            pixel[3] = (255.0 * hits / (SAMPLES * SAMPLES) as f64).round() as u8;
        }
    }
    pixels
}

/// Everything in the frame of the picture, in its middle.
fn placed(spheres: &[Sphere], lines: &[[Vec3; 2]], size: [usize; 2], fill: f64) -> Scene {
    let [right, up, toward] = frame();
    let turned = |x: &Vec3| [x.dot(&right), x.dot(&up), x.dot(&toward)];
    let mut spheres: Vec<_> = spheres.iter().map(|s| (turned(&s.centre), s.radius)).collect();
    let mut lines: Vec<_> = lines.iter().map(|l| [turned(&l[0]), turned(&l[1])]).collect();
    let ends = |k: usize| {
        let of_spheres = spheres.iter().flat_map(|(c, r)| [c[k] - r, c[k] + r]);
        let all = of_spheres.chain(lines.iter().flatten().map(|p| p[k]));
        all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
    };
    let (across, along) = (ends(0), ends(1));
    let extent = [across[1] - across[0], along[1] - along[0]].map(|e| e.max(f64::MIN_POSITIVE));
    let scale = fill * (size[0] as f64 / extent[0]).min(size[1] as f64 / extent[1]);
    let middle = [0.5 * (across[0] + across[1]), 0.5 * (along[0] + along[1])];
    let place = |p: &mut [f64; 3]| {
        *p = [
            0.5 * size[0] as f64 + (p[0] - middle[0]) * scale,
            0.5 * size[1] as f64 - (p[1] - middle[1]) * scale,
            p[2] * scale,
        ];
    };
    for (centre, radius) in &mut spheres {
        place(centre);
        *radius *= scale;
    }
    lines.iter_mut().flatten().for_each(place);
    Scene { spheres, lines, size }
}

/// Depth (greater is nearer) and number of what is seen at each sample.
fn visible(scene: &Scene) -> (Vec<f32>, Vec<u32>) {
    let [width, height] = scene.size;
    let (mut depth, mut owner) = (vec![f32::NEG_INFINITY; width * height], vec![NOTHING; width * height]);
    let mut put = |at: usize, z: f64, thing: u32| {
        if z as f32 > depth[at] {
            (depth[at], owner[at]) = (z as f32, thing);
        }
    };
    let pixels = |middle: f64, half: f64, end: usize| {
        let from = (middle - half).floor().max(0.0) as usize;
        from..((middle + half).ceil().max(0.0) as usize).min(end)
    };
    for (n, ([x, y, z], radius)) in scene.spheres.iter().enumerate() {
        for row in pixels(*y, *radius, height) {
            let dy = row as f64 + 0.5 - y;
            let half = (radius * radius - dy * dy).max(0.0).sqrt();
            for column in pixels(*x, half, width) {
                let dx = column as f64 + 0.5 - x;
                let under = radius * radius - dx * dx - dy * dy;
                if under > 0.0 {
                    put(row * width + column, z + under.sqrt(), n as u32);
                }
            }
        }
    }
    let half = 0.0009 * width as f64;
    for [from, to] in &scene.lines {
        let length = (0..2).map(|k| (to[k] - from[k]).abs()).fold(1.0, f64::max);
        for step in 0..=length as usize {
            let t = step as f64 / length;
            let [x, y, z] = std::array::from_fn(|k| from[k] + t * (to[k] - from[k]));
            for row in pixels(y, half, height) {
                for column in pixels(x, half, width) {
                    put(row * width + column, z, LINE);
                }
            }
        }
    }
    (depth, owner)
}

/// Share of the neighbourhood of a sample that is not nearer, from 0 to 1: gaps between grains are dark.
fn openness(scene: &Scene, depth: &[f32], [x, y]: [usize; 2], radius: f64) -> f64 {
    let [width, height] = scene.size;
    let here = f64::from(depth[y * width + x]);
    let mut closed = 0.0;
    for [dx, dy] in AROUND {
        let (i, j) = (x as f64 + 1.4 * radius * dx, y as f64 + 1.4 * radius * dy);
        if i >= 0.0 && j >= 0.0 && (i as usize) < width && (j as usize) < height {
            let nearer = f64::from(depth[j as usize * width + i as usize]) - here;
            closed += (nearer / radius - 0.12).clamp(0.0, 1.0);
        }
    }
    1.0 - closed / AROUND.len() as f64
}

fn shaded(scene: &Scene, sphere: &Sphere, grain: u32, [x, y]: [usize; 2], open: f64, far: f64) -> [f64; 3] {
    let ([cx, cy, _], radius) = scene.spheres[grain as usize];
    let (nx, ny) = ((x as f64 + 0.5 - cx) / radius, (cy - y as f64 - 0.5) / radius);
    let nz = (1.0 - nx * nx - ny * ny).max(0.0).sqrt();
    let light = Vec3::from(LIGHT).normalize();
    let key = (nx * light.x + ny * light.y + nz * light.z).max(0.0);
    let edge = (nz / 0.5).min(1.0);
    let brightness = (0.36 + 0.74 * key) * (0.7 + 0.3 * edge) * (0.35 + 0.65 * open);
    let glint = {
        let half = (light + Vec3::z()).normalize();
        let cos = (nx * half.x + ny * half.y + nz * half.z).max(0.0);
        let (c4, c8) = (cos.powi(4), cos.powi(8));
        26.0 * c4 * c8.powi(4)
    };
    let paler = 0.22 * far;
    sphere.colour.map(|c| (f64::from(c) * brightness + glint) * (1.0 - paler) + 236.0 * paler)
}
