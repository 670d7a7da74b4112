//! Maps of many replicates and what they say of noise and bias.

use cpu_time::ProcessTime;
use etendue::core::backend::{NoControl, PhotonJob, PhotonStart, Session, illumination_film_settings};
use etendue::core::film::Film;
use etendue::core::illumination::Elements;
use etendue::core::transport::first_shot::{Subdivision, Weights};
use etendue::core::transport::photon::Sequence;
use etendue::cpu::CpuSession;

/// One way to trace photons.
#[derive(Clone, Copy)]
pub struct Method {
    /// Its name.
    pub name: &'static str,
    /// Where photons start.
    pub start: PhotonStart,
    /// Where their numbers come from.
    pub sequence: Sequence,
}

/// The rows of the tables; the first is what the others are measured against.
pub fn methods() -> Vec<Method> {
    let lights = |survives_first| PhotonStart::Lights { registers_direct: false, survives_first };
    let surfaces = |subdivision, weights| PhotonStart::Surfaces { subdivision, weights };
    let robust = |weights| surfaces(Subdivision::robust(weights), weights);
    let (exact, density) = (Weights::EXACT, Weights::Density);
    let (random, sobol, sorted) = (Sequence::Random, Sequence::Sobol, Sequence::Sorted);
    [
        ("lights, random", lights(false), random),
        ("lights, Sobol", lights(false), sobol),
        ("lights, sorted", lights(false), sorted),
        ("lights, first hit weighted, random", lights(true), random),
        ("lights, first hit weighted, Sobol", lights(true), sobol),
        ("lights, first hit weighted, sorted", lights(true), sorted),
        ("surfaces, exact, random", robust(exact), random),
        ("surfaces, exact, Sobol", robust(exact), sobol),
        ("surfaces, exact, sorted", robust(exact), sorted),
        ("surfaces, density, random", robust(density), random),
        ("surfaces, density, Sobol", robust(density), sobol),
        ("surfaces, density, sorted", robust(density), sorted),
        ("surfaces, density, published pieces, Sobol", surfaces(Subdivision::published(), density), sobol),
        ("surfaces, density, whole triangles, Sobol", surfaces(Subdivision::None, density), sobol),
    ]
    .map(|(name, start, sequence)| Method { name, start, sequence })
    .into()
}

/// Replicates of a map and what they took.
#[derive(Default)]
pub struct Run {
    /// Irradiance per element, a map a replicate.
    pub maps: Vec<Vec<[f64; 3]>>,
    /// CPU seconds of each replicate.
    pub seconds: Vec<f64>,
    /// Rays traced.
    pub rays: u64,
    /// Arrivals registered.
    pub hits: u64,
    /// Photons traced.
    pub photons: u64,
}

impl Run {
    /// Traces one more replicate.
    pub fn add(
        &mut self,
        session: &CpuSession,
        elements: &Elements,
        method: &Method,
        seed: u64,
        photons: u32,
    ) {
        let replicate = self.maps.len() as u32;
        let job = PhotonJob {
            seed,
            photons,
            replicates: replicate..replicate + 1,
            max_hits: u32::MAX,
            start: method.start,
            sequence: method.sequence,
            elements: *elements.settings(),
        };
        if let PhotonStart::Surfaces { subdivision, weights } = method.start {
            // Kept from here on: not part of the photons' time.
            session.first_shot(&subdivision, weights).expect("a density");
        }
        let mut film = Film::new(illumination_film_settings(session.scene(), elements, &job).expect("light"));
        let start = ProcessTime::now();
        let stats = session.illumination(&job, &NoControl, &mut film).expect("a map");
        self.seconds.push(start.elapsed().as_secs_f64());
        self.rays += stats.rays;
        self.hits += stats.hits;
        self.photons += stats.paths;
        self.maps.push((0..film.len()).map(|i| film.mean(i)).collect());
    }

    /// CPU seconds of a photon: the median over the replicates.
    pub fn seconds_per_photon(&self) -> f64 {
        median(self.seconds.clone()) * self.seconds.len() as f64 / self.photons as f64
    }
}

/// The middle of some numbers.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
