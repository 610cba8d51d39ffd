//! The table of notes.

/// Calls a macro with every row: variant and constructor (also the code in messages and JSON), status that the note gives an
/// estimate, names in the sentence, numbers in the sentence (SI units), sentence without a full stop.
macro_rules! with_table {
    ($then:ident) => { $then! {
    // Estimates: data and state.

    /// The γ/Δ of the state is unknown and was taken as zero.
    GammaAssumedZero gamma_assumed_zero Ok [] () "gamma/Delta is not known and was taken as 0";
    /// γ/Δ is outside [−0.3, 0.1], where the linear overlap law of Eq. 10 costs more than 0.005 in ε.
    GammaLarge gamma_large Extrapolated [] (gamma)
        format!("gamma/Delta = {gamma:.4} is outside [-0.3, 0.1], where Eq. 10 is accurate to 0.005 in eps");
    /// γ/Δ is outside [−1/2, 1/4]: contacts in some directions would be open.
    ContactsOpen contacts_open Extrapolated [] (gamma)
        format!("gamma/Delta = {gamma:.4} is outside [-1/2, 1/4]: contacts in some directions would be open");
    /// The axial stress ratio is unknown.
    StressRatioUnknown stress_ratio_unknown Ok [] ()
        "the axial stress ratio is not known: it is 0 +- 0.15, cut at +- 0.3, in value and error; a sample at rest in its bed \
         (K0, about 0.75) is outside";
    /// The sizes of the grains are unknown.
    SizesUnknown sizes_unknown Ok [] ()
        "the spread of the grain sizes is not known: any from 0 to 0.3 is equally probable, in value and error";
    /// The number of grains is unknown; the scatter is the mean over a range of numbers.
    GrainsUnknown grains_unknown Ok [] ()
        "the number of grains is not known: the error is that of 100 to 20,000 grains, each number as probable on a logarithmic scale";
    /// Contacts may have slid while the moduli were measured; the numbers are the standard deviations that are added.
    ProbeUnknown probe_unknown Ok [] (z k eps)
        format!("contacts may have slid while the moduli were measured: standard deviations of {z} in z, {k} in k and {eps} in eps \
                 are added, and eps_stiffness widens with eps");
    /// An input of the state contributes most of the variance of a quantity.
    WidenedMost widened_most Ok [input quantity] (share)
        format!("{input} widens most: {:.0} % of the variance of {quantity} is due to it", share * 100.0);
    /// The grains have another Poisson ratio than the packings of the calibration.
    OtherGrains other_grains Extrapolated [] (poisson calibrated)
        format!("the Poisson ratio of the grains is {poisson}, that of the calibration {calibrated}: moduli are scaled by the \
                 Hertz modulus alone");
    /// A quantity of the state is outside the packings of the calibration.
    StateOutsideCalibration state_outside_calibration Extrapolated [quantity] (value low high) {
        let range = [low, high];
        // Decimals do not show p/E*.
        let [value, low, high] =
            if quantity.starts_with("p/E*") { value.outside_by_exponent(range, 2) } else { value.outside(range, 4) };
        format!("{quantity} = {value} is outside {low} to {high}, the range of the calibration's packings")
    };
    /// The pressure, Pa, is outside the packings of the calibration.
    PressureOutsideCalibration pressure_outside_calibration Extrapolated [] (pressure low high) {
        let [p, low, high] = (pressure * 1e-3).outside([low * 1e-3, high * 1e-3], 4);
        format!("a pressure of {p} kPa is outside {low} to {high} kPa, the range of the calibration's packings")
    };
    /// The error of a modulus is too large for linear error propagation.
    ErrorsLarge errors_large Ok [modulus] (relative)
        format!("{modulus} is known to {:.0} % only: intervals from linear error propagation are too narrow", relative * 100.0);
    /// The error of an input of the state is too large for linear error propagation.
    StateErrorLarge state_error_large Ok [input] (relative)
        format!("the {input} is known to {:.0} % only: intervals from linear error propagation are too narrow", relative * 100.0);
    /// The error of a modulus is so large that the modulus was taken as unknown.
    TakenAsUnknown taken_as_unknown Ok [modulus] (factor)
        format!("the error of {modulus} is more than {factor} times the largest modulus: {modulus} was taken as unknown");
    /// The errors of the moduli are unknown, and the uncertainty is without them.
    DataErrorUnknown data_error_unknown Ok [] ()
        "the errors of the moduli are not known: the uncertainty does not include them";
    /// The stiffness is not isotropic about the axis.
    NotTransverselyIsotropic not_transversely_isotropic Extrapolated [] (asymmetry)
        format!("{:.1} % of the stiffness is not isotropic about the axis: the sample is not, or the axis is wrong",
                asymmetry * 100.0);
    /// No stable medium has these moduli.
    NotOneMedium not_one_medium Contradictory [] ()
        "no stable medium has these moduli: they are not of one state, or the errors are large";
    /// Θ differs from the value that follows from C11, C33, C13 and G12 by more than the errors.
    Imbalance imbalance Contradictory [] (relative)
        format!("Theta is {:.1} % off the value that follows from C11, C33, C13 and G12: they are not of one state, or one of \
                 them is wrong", relative.abs() * 100.0);
    /// The data contradict each other, or the model: the modulus is furthest from its prediction by the others.
    Conflict conflict Contradictory [modulus] (chi_square degrees_of_freedom sigma) {
        let about = if degrees_of_freedom == Shown::from(1.0) {
            "1 degree of freedom, so that any of them may be wrong".to_owned()
        } else {
            format!("{degrees_of_freedom} degrees of freedom, {modulus} is {sigma:.1} sigma from its prediction by the others")
        };
        format!("the moduli contradict each other or the model: chi-square {chi_square:.1} for {about}")
    };
    /// The moduli fit no structure of the calibration's packings well.
    Unlike unlike Extrapolated [] (probability)
        format!("the moduli fit the calibration's packings badly (p = {probability:.1e}): the sample is of another kind, or the errors are \
                 larger than given; do not rely on the stated errors");
    /// The moduli are improbable under the posterior, although their χ² about the estimate is ordinary.
    Improbable improbable Contradictory [] (probability)
        format!("the moduli are improbable under the posterior (p = {probability:.0e}): the sample is unlike the packings of the \
                 calibration, or the errors are larger than given");

    // Estimates: contacts.

    /// The contact law is unknown; Hertz–Mindlin contacts were assumed.
    ContactLawAssumed contact_law_assumed Ok [] ()
        "the contact law is not known: the contacts were taken as Hertz-Mindlin contacts";
    /// Unknown contacts are inferred with the structure: k_t/k_n, its standard deviation, and the moduli divided by the moduli of smooth contacts.
    ContactsInferred contacts_inferred Ok [] (ratio stddev level)
        format!("the contacts are not known, and are inferred: k_t/k_n {ratio:.2} +- {stddev:.2}, moduli {level:.2} times those of smooth contacts; z \
                 follows from the ratio of the moduli, and from simulated preparations");
    /// The contacts have another law than the contacts of the calibration.
    ContactsStated contacts_stated Ok [law] ()
        format!("{law} contacts: the model takes their k_t/k_n, and not {}, because it takes no size of the grains; z follows from the ratio \
                 of the moduli, and from simulated preparations", if law == "rough" { "their roughness" } else { "their stiffness" });
    /// No contacts of these grains have such moduli.
    FarLevel far_level Contradictory [] (ratio)
        format!("the moduli are {ratio:.2} times those of the contacts of these grains: check pressure, material, density and units");
    /// The model has contacts in all directions alike.
    IsotropicContacts isotropic_contacts Ok [] ()
        "the model has contacts in all directions alike: eps is unknown, not zero";
    /// The share of the contacts that stick in a shear wave, which makes the model fit Θ and the shear modulus.
    StickingShare sticking_share Ok [] (share)
        format!("the shear modulus over Theta is that of contacts of which a share f = {share:.3} sticks");
    /// The same share, outside [0, 1].
    StickingShareOutside sticking_share_outside Extrapolated [] (share)
        format!("the shear modulus over Theta is that of contacts of which a share f = {share:.3} (outside [0, 1]) sticks");
    /// The contacts resist rolling; the contacts of the calibration do not.
    RollingResistance rolling_resistance Extrapolated [] ()
        "the contacts resist rolling; no model knows packings whose contacts do";

    // Estimates: the inferred structure.

    /// A coordination number is below the packings of the calibration.
    BelowCalibration below_calibration Extrapolated [quantity] (value low) {
        let [value, low, _] = value.outside([low, low], 3);
        format!("{quantity} = {value} is below {low}, the lowest of the calibration's packings")
    };
    /// A coordination number is above the packings of the calibration.
    AboveCalibration above_calibration Extrapolated [quantity] (value high) {
        let [value, high, _] = value.outside([high, high], 3);
        format!("{quantity} = {value} is above {high}, the highest of the calibration's packings")
    };
    /// The anisotropy is outside the packings of the calibration.
    AnisotropyOutsideCalibration anisotropy_outside_calibration Extrapolated [quantity] (value low high) {
        let [value, low, high] = value.outside([low, high], 4);
        format!("{quantity} = {value} is outside [{low}, {high}], the range of the calibration's packings")
    };
    /// A coordination number is larger than equal spheres can have.
    CoordinationImpossible coordination_impossible Extrapolated [] (coordination)
        format!("a coordination number of {coordination:.3} is larger than equal spheres can have (12): check the units (Pa)");
    /// A coordination number is less than one contact per grain.
    CoordinationAbsurd coordination_absurd Extrapolated [quantity] (value)
        format!("{quantity} = {value:.3} is less than one contact per grain: check the units of moduli and pressure (Pa)");
    /// G13/G12 is outside [2/3, 3/2], the range of packings that are anisotropic in their contacts alone.
    RatioUnusual ratio_unusual Extrapolated [] (ratio)
        format!("G13/G12 = {ratio:.4} is outside [2/3, 3/2], the range of contact anisotropy alone");
    /// ε is outside [−1/2, 1]: Eq. 6 then gives some directions a negative contact density.
    EpsOutOfRange eps_out_of_range Extrapolated [] (eps)
        format!("eps = {eps:.4} is outside [-1/2, 1]: the contact density would be negative in some directions");
    /// The estimate is outside the domain of the model.
    OutsideDomain outside_domain Extrapolated [quantity] (value low high) {
        let [value, low, high] = value.outside([low, high], 4);
        format!("{quantity} = {value} is outside [{low}, {high}], the domain of the model")
    };
    /// The data do not determine some unknowns of the model.
    Undetermined undetermined Extrapolated [quantities] () format!("the data do not determine {quantities}");
    /// The data say little of a quantity: this share of the standard deviation of its prior is left.
    HardlyDetermined hardly_determined Ok [quantity] (left)
        format!("the data hardly determine {quantity}: {:.0} % of the standard deviation of its prior is left", left * 100.0);
    /// The posterior contains higher z than are stated.
    HigherZ higher_z Ok [] (share)
        format!("{:.0} % of the posterior has z above 6.6, where nothing is stated", share * 100.0);
    /// The posterior contains lower z than the packings of the calibration have.
    LowerZ lower_z Ok [] (share lowest)
        format!("{:.0} % of the posterior has z below {lowest:.2}, the lowest of the calibration's packings", share * 100.0);

    // Estimates: priors.

    /// The data contradict the prior of a quantity.
    PriorConflict prior_conflict Contradictory [quantity] (value prior sigma)
        format!("the data alone give {quantity} = {value:.4}, {sigma:.1} sigma from {prior:.4}, the mean of its prior");
    /// The data contradict a limit of the prior of a quantity.
    PriorExcludes prior_excludes Contradictory [quantity] (value limit sigma)
        format!("the data alone give {quantity} = {value:.4}, {sigma:.1} sigma beyond {limit:.4}, the limit of its prior");
    /// The data contradict the priors of several quantities together.
    PriorsConflict priors_conflict Contradictory [] (chi_square quantities)
        format!("the priors together contradict the data: chi-square {chi_square:.1} for {quantities} quantities with a prior");
    /// The data do not determine a quantity, so that its prior has no effect.
    PriorUnused prior_unused Ok [quantity] ()
        format!("the data do not determine {quantity}, and its prior is not used; draws from the posterior use it");

    // Estimates: wave speeds.

    /// A wave is predicted badly by the others of its medium; the others leave this scatter of ρv².
    SpeedsDepart speeds_depart Ok [] (scatter)
        format!("rho v^2 of the wave speeds scatters by {:.1} % about a medium isotropic about the axis, more than their errors \
                 do: the sample is not quite one, and {:.2} % were added to the error of every speed", scatter * 100.0, scatter * 50.0);
    /// The wave speeds contradict each other: this one is furthest from its prediction by the others.
    SpeedsContradict speeds_contradict Contradictory [speed] (chi_square degrees_of_freedom sigma)
        format!("the wave speeds contradict each other: chi-square {chi_square:.1} for {degrees_of_freedom} degrees of freedom, {speed} \
                 is {sigma:.1} sigma from the prediction by the others");
    /// The wave speeds do not determine some moduli.
    SpeedsLeaveOpen speeds_leave_open Ok [moduli] () format!("the wave speeds do not determine {moduli}");
    /// Some wave speeds have no standard deviation.
    SpeedErrorsTaken speed_errors_taken Ok [] (assumed speeds)
        format!("{assumed} of {speeds} wave speeds have no standard deviation: the largest relative one of the others was taken");
    /// No wave speed has a standard deviation; every modulus has this relative one.
    SpeedErrorsUnknown speed_errors_unknown Ok [] (error)
        format!("no wave speed has a standard deviation: every modulus has one of {} %", error * 100.0);
    /// An axis was found from the speeds, with a standard deviation in degrees.
    AxisFound axis_found Ok [] (x y z degrees sigma)
        format!("no axis was named: ({x:.4}, {y:.4}, {z:.4}) was found from the speeds, to {degrees:.1} degrees (one sigma), \
                 preferred to isotropy by {sigma:.1} sigma");
    /// No axis was named, and the speeds have none.
    AxisTaken axis_taken Ok [reason] () format!("no axis was named, and e3 was taken: {reason}");
    /// The axis taken is not the axis of the data.
    AxisDiffers axis_differs Ok [] (x y z named_x named_y named_z)
        format!("the axis taken is ({x:.3}, {y:.3}, {z:.3}), and the data name ({named_x:.3}, {named_y:.3}, {named_z:.3}): set the \
                 parameter axis to found if theirs is meant");
    /// The wave speeds fit another axis better: the scatters of ρv² are about that axis and about the one taken.
    OtherAxisFits other_axis_fits Contradictory [] (x y z scatter taken)
        format!("the wave speeds fit another axis better: about ({x:.4}, {y:.4}, {z:.4}) rho v^2 scatters by {:.2} %, about the one \
                 taken by {:.2} %; set the parameter axis", scatter * 100.0, taken * 100.0);
    /// The moduli are about e3 for want of an axis.
    NoAxis no_axis Ok [reason] () format!("no axis stands out in the speeds, and the moduli are about e3: {reason}");
    /// A note that came with the wave speeds.
    InstrumentReports instrument_reports Ok [text] () format!("the instrument reports: {text}");

    // Packings.

    /// A remark of the reader of a file, or of another program.
    Remark remark Ok [text] () text.clone();
    /// The packing was recorded within a phase.
    WithinPhase within_phase Ok [] (phase)
        format!("recorded within phase {phase}, which had not met its end conditions: the packing need not be at rest");
    /// Forces do not balance: the mean net force of a grain over the mean contact force, and its limit.
    UnbalancedForces unbalanced_forces Ok [] (ratio limit)
        format!("forces do not balance: the mean net force of a grain is {ratio:.2e} of the mean contact force (more than \
                 {limit}): the packing moves, or contact forces are missing or wrong; stress and stiffness are those of a packing \
                 that is not at rest");
    /// Torques do not balance: the mean net torque of a grain over the mean torque of a tangential force, and its limit.
    UnbalancedTorques unbalanced_torques Ok [] (ratio limit)
        format!("torques do not balance, although forces do: the mean net torque of the tangential forces of a grain is {:.0} % of the \
                 mean torque of one of them (more than {:.0} %): a resistance to rolling that the file does not name, without which \
                 shear moduli are too low, or tangential forces of another time than the positions; state it (--contact-law \
                 hertz_mindlin:KR,CR,MUR), or check the forces", ratio * 100.0, limit * 100.0);
    /// The packing is in motion: kinetic over elastic energy, and its limit.
    InMotion in_motion Ok [] (ratio limit)
        format!("the packing is in motion: the kinetic energy of its grains that carry force, about their mean velocity, is {ratio:.1e} of \
                 half the sum of normal force times overlap (more than {limit}); check the velocities and their units, or let it come to rest");
    /// The packing consists of copies; errors are too small by a factor.
    Copies copies Ok [] (copies grains factor)
        format!("the packing is {copies} identical copies of {grains} grains: standard deviations count each copy as independent and are too \
                 small by a factor of {factor:.2} or more, and a lower symmetry may be found than there is; analyze the one of {grains} grains");
    /// Θ, Pa, is below its lower bound, Pa.
    BelowBound below_bound Ok [] (theta bound)
        format!("Theta {theta:.4e} Pa is below its lower bound by the forces present, {bound:.4e} Pa: contacts are missing, or forces are \
                 not those of a packing at rest");
    /// The stiffness is negative under some strain.
    NegativeStiffness negative_stiffness Ok [] ()
        "the stiffness is negative under some strain: the packing is stable only while that strain is held";
    /// Some strain meets no resistance.
    NoResistance no_resistance Ok [] ()
        "some strain of the cell meets no resistance: the contacts do not span it in every direction; moduli of 0 are those of \
         no packing at rest";
    /// No grains fill a cell so far.
    Overfull overfull Ok [] (solid_fraction)
        format!("solid fraction {solid_fraction:.3}: no grains fill a cell so far; check the units of cell and radii");
    /// This share of the grains has the surroundings of a crystal.
    Crystalline crystalline Ok [] (share)
        format!("{:.0} % of the grains have the surroundings of a crystal (by bond-orientational order; in random packings at most a few \
                 have): they have crystallised, as grains of one size do in small cells and at flat walls; the inversion was calibrated \
                 on random packings", share * 100.0);
    /// The anisotropy has another axis than the reference axis: that axis, its angle in degrees, the reference axis, ε about the
    /// axis of the contacts with its standard deviation, that axis, and ε about the reference axis.
    AnotherAxis another_axis Ok [] (x y z angle used_x used_y used_z eps stddev own_x own_y own_z used_eps)
        format!("the packing has its axis at ({x:.2}, {y:.2}, {z:.2}), {angle:.0} degrees from the axis ({used_x:.2}, {used_y:.2}, {used_z:.2}) \
                 of eps, G12, G13 and the estimates: the contacts have eps {eps:.3} +- {stddev:.3} about ({own_x:.2}, {own_y:.2}, {own_z:.2}), \
                 their own axis, and {used_eps:.3} about the one used; measure it by analyze --axis {x:.2},{y:.2},{z:.2}");
    /// Contacts overlap by more than any contact law holds for.
    OverlapsTooDeep overlaps_too_deep Ok [cause] (beyond contacts first second limit largest) {
        let [one, many] = ["the contact".to_owned(), format!("{beyond} of {contacts} contacts")];
        let number = if contacts == Shown::from(1.0) { one } else { many };
        let verb = if beyond == Shown::from(1.0) { "overlaps" } else { "overlap" };
        format!("{number} {verb} by more than {:.0} % of the smaller diameter, the deepest, of grains {first} and {second}, by {:.0} %: no contact \
                 law holds there, and there are no moduli; {cause}", limit * 100.0, largest * 100.0)
    };
    /// Contacts overlap by more than Hertz's law holds for.
    OverlapsDeep overlaps_deep Ok [] (largest limit first second)
        format!("contacts overlap by up to {:.1} % of the smaller diameter (more than {:.0} %), the deepest of grains {first} and {second}: \
                 Hertz's law, which is for contacts far smaller than the grains, no longer holds, and forces and moduli are \
                 only approximate", largest * 100.0, limit * 100.0);
    /// Few contacts cross planes of the cell.
    Open open Ok [edges fewest expected] ()
        format!("the packing is open across {edges} of the cell: a plane there is crossed by only {fewest} contacts, where {expected} are expected. It lies \
                 between walls, or has a free surface, and is measured as if its cell were periodic: its stiffness is not the one of the \
                 packing, and contacts with walls are missing");
    /// Contacts overlap by position and are not listed.
    NotListed not_listed Ok [] (contacts first second)
        format!("{}, the first of grains {first} and {second}", counted(contacts, "overlaps by position but is not listed", "overlap by position but are not listed"));
    /// Contacts are listed and do not overlap by position.
    NotTouching not_touching Ok [] (contacts first second)
        format!("{}, the first of grains {first} and {second}", counted(contacts, "is listed but does not overlap by position", "are listed but do not overlap by position"));
    /// Normal forces differ from the contact law by this share on average.
    OtherForces other_forces Ok [law] (difference)
        format!("normal forces differ from the contact law by {:.1} % on average: of another contact law, another material, \
                 rounded positions, or in motion; the stiffness is that of {law} contacts of this material", difference * 100.0);
    /// Contacts carry more tangential force than the friction allows.
    BeyondFriction beyond_friction Ok [] (contacts friction first second) {
        let more = format!("more tangential force than a friction of {friction} allows");
        let what = counted(contacts, &format!("carries {more}"), &format!("carry {more}"));
        format!("{what}, the first of grains {first} and {second}: of another friction, or in motion")
    };
    /// Contacts pull.
    Pulling pulling Ok [] (contacts first second)
        format!("{}, the first of grains {first} and {second} (normal force below 0): the contact law only presses", counted(contacts, "pulls", "pull"));

    // Stiffnesses and waves, named by the first word of the sentence.

    /// The rolling springs are left out.
    WithoutRolling without_rolling Ok [what] ()
        format!("{what} without the rolling springs of the contact law: the shear moduli may be several times too low; the strain probe \
                 (analyze --method probe) has the whole law");
    /// There are no tangential springs, as in the packing.
    Frictionless frictionless Ok [what] ()
        format!("{what} without tangential springs, since its contacts carry no tangential force (friction 0); no inversion is calibrated for \
                 that");
    /// The prestress is left out, although the packing has no friction.
    WithoutPrestress without_prestress Ok [what] ()
        format!("{what} without prestress, which lowers the moduli of packings without friction near isostaticity (analyze has --method \
                 prestressed)");
    /// There are no tangential springs, although the packing has friction.
    TangentialLeftOut tangential_left_out Ok [what] (friction)
        format!("{what} without tangential springs, as asked, although contacts carry tangential forces (friction {friction}); no inversion is \
                 calibrated for that");
    /// There are tangential springs, although the packing has no friction.
    TangentialAdded tangential_added Ok [what] ()
        format!("{what} with tangential springs, as asked, although contacts without friction carry no tangential force");
    /// Sliding contacts, this share of all, have a tangential spring.
    SlidingStuck sliding_stuck Ok [what] (share)
        format!("{what} with the tangential springs of all contacts, also of the {:.1} % at the Coulomb limit: the response to a strain so \
                 small that none slides", share * 100.0);

    // Why there is no stiffness.

    /// No two grains touch.
    NoContacts no_contacts Unknown [] (grains)
        format!("no contact network: none of the {grains} grains touches another; compress the packing first");
    /// Every grain was removed as a rattler.
    OnlyRattlers only_rattlers Unknown [] (grains needed)
        format!("no contact network: all {grains} grains are rattlers (fewer than {needed} contacts each, found recursively); \
                 compress the packing first (contacts with walls do not count)");
    /// Contacts exist but resist no deformation of the cell.
    Floppy floppy Unknown [] (contacts)
        format!("no strain is resisted, so that all moduli are 0: the {contacts} contacts do not span the cell, or are too few for the \
                 springs that they have; check friction and boundaries, or compress the packing first");
    /// Grains overlap by more than this share of a diameter: no contact law holds.
    TooDeep too_deep Unknown [] (limit)
        format!("grains overlap by more than {:.0} % of a diameter, where no contact law holds: there are no moduli", limit * 100.0);
    /// The stiffness could not be computed, or the result was withheld.
    Unsolved unsolved Unknown [] () "the stiffness could not be computed: the moduli are unknown";

    // Waves.

    /// The response to a wave is nonlinear: peak strain, contacts opened and closed, and relative change of the trace.
    Nonlinear nonlinear Ok [direction polarization] (amplitude opened closed change)
        format!("the response along {direction}, polarization {polarization}, is nonlinear: {opened} contacts opened, {closed} closed at a strain of \
                 {amplitude:e}, the trace changes by {change:.1e} of itself at half of that; reduce the amplitude");
    /// A speed has a large relative error.
    Noisy noisy Ok [direction polarization] (relative)
        format!("the speed along {direction}, polarization {polarization}, has a relative error of {relative:.1e}; average more shots if there is noise, \
                 reduce the amplitude if contacts open");
    /// The packing did not come to rest.
    NotAtRest not_at_rest Ok [] (unbalanced)
        format!("the packing did not come to rest (unbalanced force ratio {unbalanced:.1e}): its own motion is superposed on the waves; \
                 relax it further, or increase the amplitude");
    /// The waves are too short for an extrapolation to long ones: the last term of the series over the one before.
    TooShort too_short Ok [direction] (ratio)
        format!("the waves along {direction} are too short: the last term of their series is {ratio:.1} times the one before at the shortest, \
                 and the stated errors may be too small; use longer waves");
    /// A mode was left out.
    LeftOut left_out Ok [reason] () format!("left out: {reason}");

    // Why there is no estimate.

    /// Another reason, in words.
    NoAnswer no_answer Unknown [reason] () reason.clone();
    /// A structure follows from the moduli that no packing has.
    NoPacking no_packing Unknown [quantity] (value low high)
        format!("unknown: from these moduli follows {quantity} = {value:.3}, outside {low} to {high}, the range of every packing of \
                 spheres: check the units of moduli and pressure (Pa), and the material");
    /// The contacts are not Hertz–Mindlin contacts.
    OtherContactLaw other_contact_law Unknown [law] ()
        format!("unknown: the contact law is {law}; this model is for Hertz-Mindlin contacts, whose stiffness follows from the material \
                 of the grains: free-contact is for others");
    /// The moduli belong to contacts without tangential springs.
    SmoothGrains smooth_grains Unknown [] ()
        "unknown: the moduli are those of smooth grains, whose contacts have no tangential springs; every model is for \
         contacts that have them";
    /// A modulus, Pa, that follows from the others makes the medium unstable.
    Unstable unstable Unknown [modulus] (value)
        format!("from the other moduli follows {modulus} = {value:e} Pa: they are not of one medium, or not of one state");
    /// A structure or a state is outside the domain of a model.
    BeyondDomain beyond_domain Unknown [quantity model] (value low high)
        format!("{quantity} = {value} is outside [{low}, {high}], the domain of model {model}");
    /// The strain ratio makes the stiffness of contacts negative.
    GammaOutOfRange gamma_out_of_range Unknown [] (gamma)
        format!("gamma/Delta = {gamma} is outside (-1, 1/2), where Eq. 10 gives every contact a positive stiffness; give the elastic or \
                 the contact-fitted ratio, or 0");
    /// No contact distribution has this shear ratio.
    RatioOutOfRange ratio_out_of_range Unknown [] (ratio)
        format!("G13/G12 = {ratio:.4} is outside (0, 2), the range of the theory: check that G13 is the shear modulus along the axis");
    /// No contact anisotropy gives this shear ratio at this strain ratio.
    NoAnisotropy no_anisotropy Unknown [] (ratio gamma)
        format!("no contact anisotropy gives G13/G12 = {ratio:.4} at gamma/Delta = {gamma}: the strain ratio differs too much from that \
                 of the contacts; give the elastic or the contact-fitted ratio, or 0");
    /// The shear modulus is too large relative to the bulk modulus.
    ShearTooStiff shear_too_stiff Unknown [calibration] (ratio limit)
        format!("G12/Theta = {ratio:.4} is not below {limit:.4}, the limit of calibration `{calibration}` at infinite coordination: \
                 check the units and that both moduli are of one state, or use another calibration");
    /// No coordination number of the calibration gives such moduli.
    NoCoordination no_coordination Unknown [calibration] (nearest low high)
        format!("no coordination number of calibration `{calibration}` (from {low:.3} to {high:.3}) gives such moduli; those of {nearest:.3} \
                 differ least: check units, pressure and material");
    /// The packing differs too much from the packings of the calibration.
    TooFar too_far Unknown [quantity calibration] (value low high) {
        let range = [low, high];
        let [value, low, high] =
            if quantity.starts_with("p/E*") { value.outside_by_exponent(range, 2) } else { value.outside(range, 4) };
        format!("unknown: {quantity} = {value} is too far from the packings of calibration `{calibration}`, [{low}, {high}], for an estimate")
    };
    /// Two coordination numbers explain the observation almost equally well.
    Ambiguous ambiguous Unknown [] (first second)
        format!("coordination numbers {first:.3} and {second:.3} explain the moduli almost equally well: give more, or more accurate, \
                 moduli");
    } };
}

pub(super) use with_table;
