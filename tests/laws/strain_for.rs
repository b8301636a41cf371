//! Source: relaxation of stresses, `docs/theory/relaxed-tls.md`. Goal: the strain that a law gives for a
//! change of stress makes that change. Parameters: changes of 1e-6 of the modulus in random directions;
//! material at rest, and strained at random by up to 0.45. Expected: at rest the change itself, to its own
//! size squared. Strained, material is stiffer along some axes than along others: what comes out is no more
//! than twice the change, and never points the other way.

use materialpoint::law::{
    ConeMatch, ConstitutiveLaw, DruckerPrager, Hencky, NeoHookean, NewtonianFluid, StVenantKirchhoff,
    Strength, VonMises,
};
use nalgebra::SMatrix;

use super::{Specimen, gradients, moduli, random};

/// Share of the change that comes out, and the part of the rest, both over the change.
fn answer<const D: usize, L: ConstitutiveLaw<f64, D>>(
    specimen: &Specimen<'_, D, L>,
    change: &SMatrix<f64, D, D>,
) -> Option<[f64; 2]> {
    let density = 1e3 / specimen.volume;
    let strain = specimen
        .law
        .strain_for(change, density, &specimen.stress, &specimen.state)?;
    let mut moved = *specimen;
    moved.update(&strain);
    let found = moved.stress - specimen.stress;
    let share = found.dot(change) / change.norm_squared();
    Some([share, (found - change * share).norm() / change.norm()])
}

fn changes<const D: usize>() -> impl Iterator<Item = SMatrix<f64, D, D>> {
    (100..120).map(|seed| {
        let any = random::<D>(seed);
        (any + any.transpose()) * 10.0
    })
}

fn check<const D: usize, L: ConstitutiveLaw<f64, D>>(law: &L, strained: bool) {
    for change in changes::<D>() {
        let [share, rest] = answer(&Specimen::new(law), &change).unwrap();
        assert!((share - 1.0).abs() < 1e-5 && rest < 1e-5, "{share} {rest}");
        for f in gradients::<D>().filter(|_| strained) {
            let mut specimen = Specimen::new(law);
            specimen.update(&(f - SMatrix::identity()));
            let [share, _] = answer(&specimen, &change).unwrap();
            assert!((0.0..2.0).contains(&share), "{f} {share}");
        }
    }
}

#[test]
fn elastic_laws_make_the_change() {
    let moduli = moduli();
    check::<2, _>(&NeoHookean { moduli }, true);
    check::<3, _>(&NeoHookean { moduli }, true);
    check::<2, _>(&Hencky { moduli }, false);
    check::<3, _>(&Hencky { moduli }, false);
    check::<2, _>(&StVenantKirchhoff { moduli }, false);
    let von_mises = VonMises::new(moduli, 1e6, 1e5).unwrap();
    check::<3, _>(&von_mises, false);
}

/// A fluid answers with its pressure, the only part of its stress that follows from the state; separated
/// fluid and sand not at all.
#[test]
fn fluids_answer_with_their_pressure_and_separated_material_not_at_all() {
    let water = NewtonianFluid::new(2e6, 7.0, 1e-3).unwrap();
    let mut pressed = Specimen::<2, _>::new(&water);
    pressed.stretch([-0.01, -0.02], 10);
    for change in changes::<2>() {
        let even = SMatrix::<f64, 2, 2>::identity() * (change.trace() / 2.0);
        let [share, rest] = answer(&pressed, &even).unwrap();
        assert!((share - 1.0).abs() < 1e-4 && rest < 1e-9, "{share} {rest}");
        let [_, rest] = answer(&pressed, &(change - even)).unwrap();
        assert!((rest - 0.0).abs() < 1e-9);
    }
    let strength = Strength {
        cohesion: 0.0,
        friction_angle: 0.6,
        dilation_angle: 0.0,
    };
    let sand = DruckerPrager::new(moduli(), &strength, ConeMatch::PlaneStrain).unwrap();
    let change = SMatrix::<f64, 2, 2>::identity();
    let mut apart = Specimen::<2, _>::new(&water);
    apart.stretch([0.1, 0.1], 10);
    assert_eq!(answer(&apart, &change), None);
    let mut apart = Specimen::<2, _>::new(&sand);
    apart.stretch([0.1, 0.1], 10);
    assert_eq!(answer(&apart, &change), None);
}

/// A law of one's own that says nothing: its stress moves in the right direction, by no more than four thirds
/// here.
#[test]
fn any_other_law_moves_in_the_right_direction() {
    struct Own(Hencky<f64>);
    impl<const D: usize> ConstitutiveLaw<f64, D> for Own {
        type State = <Hencky<f64> as ConstitutiveLaw<f64, D>>::State;
        fn large_strain(&self) -> bool {
            true
        }
        fn update(&self, d: &SMatrix<f64, D, D>, stress: &mut SMatrix<f64, D, D>, state: &mut Self::State) {
            self.0.update(d, stress, state);
        }
        fn wave_speed(&self, density: f64, stress: &SMatrix<f64, D, D>, state: &Self::State) -> f64 {
            self.0.wave_speed(density, stress, state)
        }
        fn energy_density(&self, stress: &SMatrix<f64, D, D>, state: &Self::State) -> f64 {
            self.0.energy_density(stress, state)
        }
    }
    let own = Own(Hencky { moduli: moduli() });
    for change in changes::<2>() {
        let [share, _] = answer(&Specimen::new(&own), &change).unwrap();
        assert!((0.5..1.5).contains(&share), "{share}");
    }
}
