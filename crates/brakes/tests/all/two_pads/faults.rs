//! Refusals of cases of the brake of two pads, each in one line.

use super::{CASE, Folder, in_equilibrium};

/// Elements that are not integrated over: neither do they vanish from a set, nor is a face towards them one at which a body ends. Where a
/// surface has it by its number it is refused, of the outer faces of a set it is none.
#[test]
fn elements_of_other_types_are_not_passed_over() {
    let folder = Folder::new();
    let deck_path = folder.folder.path().join("brake.inp");
    let deck = std::fs::read_to_string(&deck_path).unwrap();
    let (_, lining) = deck.split_once("ELSET=OUT\n").unwrap();
    let nodes: Vec<&str> =
        lining.split(|c: char| !c.is_ascii_digit()).filter(|word| !word.is_empty()).skip(1).collect();
    let corners = |count: usize| nodes[..count].join(", ");
    folder.parse(CASE.into()).unwrap();
    for (of_type, count) in [("C3D5", 5), ("COH3D8", 8), ("SC8R", 8)] {
        for (set, said) in [
            ("OUT", "\"OUT\" with element 900001, which is another; allowed: a set of solid elements".to_owned()),
            (
                "SHIM",
                format!(
                    "contact \"outer\".slave = \"LINING\", S1: a face towards element 900001 of type {of_type}; allowed: outer"
                ),
            ),
        ] {
            let element = format!("*ELEMENT, TYPE={of_type}, ELSET={set}\n900001, {}\n", corners(count));
            std::fs::write(&deck_path, format!("{deck}{element}")).unwrap();
            let error = folder.parse(CASE.into()).unwrap_err();
            assert!(error.contains(&said), "{of_type}: {error}");
        }
    }
    // A plate on the backs of two elements.
    let backs = [4, 5, 6, 7, 25, 26, 27, 28].map(|at| nodes[at]).join(", ");
    for (of_type, slave) in [("COH3D8", "OUT"), ("SC8R", "OUT"), ("COH3D8", "LINING")] {
        let case = CASE.replace("slave = \"LINING\"", &format!("slave = \"{slave}\""));
        let contact = || folder.parse(case.clone()).map(|case| format!("{:?}", case.contact)).unwrap();
        std::fs::write(&deck_path, &deck).unwrap();
        let without = contact();
        std::fs::write(&deck_path, format!("{deck}*ELEMENT, TYPE={of_type}, ELSET=PLATE\n900001, {backs}\n")).unwrap();
        assert!(contact() == without, "{of_type} {slave}");
    }
}

#[test]
fn faults_are_one_line_with_file_field_and_what_is_allowed() {
    let folder = Folder::new();
    let many = CASE.to_owned();
    let balanced = in_equilibrium();
    let sideways = ["OUTER", "INNER"].iter().zip([1.5, 1.2]).fold(balanced.clone(), |text, (set, pressure)| {
        let along = format!("nodes = \"{set}\"\nforce = [500.0, 0.0, 0.0]");
        let held = format!(
            "[[springs]]\nname = \"{set} z\"\nnodes = \"{set}\"\ndirection = [0.0, 0.0, 1.0]\nstiffness = 6e4\n[all_contacts]"
        );
        text.replace(&format!("faces = \"{set}\"\npressure = {pressure}"), &along).replace("[all_contacts]", &held)
    });
    let in_mm = CASE.replace("[brake]", "[units]\nsystem = \"mm-t-s\"\n[brake]");
    folder.parse(in_mm.clone()).unwrap();
    let faults = [
        (
            &many,
            "slave = \"LINING\"",
            "slave = \"LINNING\"",
            "contact \"outer\".slave = \"LINNING\"; allowed: a surface (LINING, UNION), a node set (HUB",
        ),
        (
            &many,
            "slave = \"LINING\"",
            "slave = \"UNION\"",
            "\"UNION\" with COMBINE; allowed: a surface of TYPE=ELEMENT",
        ),
        (&many, "slave = \"LINING\"", "slaves = \"LINING\"", "unknown field `slaves`"),
        (&many, "master = \"TOP\"", "master = \"OUTER\"", "contact \"outer\": the faces do not meet: node"),
        (&many, "slave = \"IN\"", "slave = \"INNER\"", "contact \"inner\": the faces do not meet: node"),
        (
            &many,
            "slave = \"LINING\"\nmaster = \"TOP\"",
            "slave = \"DISC\"\nmaster = \"LINING\"",
            "contact \"outer\": the master is smaller than the slave:",
        ),
        (&many, "reach = 0.5", "reach = 0.0", "contact \"outer\": the reach of a contact is 0; allowed"),
        (
            &many,
            "sliding = { axis = [0.0, 0.0, 1.0] }",
            "sliding = { axis = [0.0, 0.0, 1.0], through = [0.0, 120.0, 0.0] }",
            "the axis of rotation goes through the slave, at node",
        ),
        (&many, "sliding = { axis = [0.0, 0.0, 1.0] }", "sliding = [0.0, 0.0, 1.0]", "nothing slides at node"),
        (
            &many,
            "stiffness = { per_area = 110.0 }",
            "stiffness = { per_area = -1.0 }",
            "contact \"outer\".stiffness: the stiffness of a contact by area is -1",
        ),
        (
            &many,
            "stiffness = { per_area = 110.0 }",
            "stiffness = { c = 5.0, m = 0.5 }",
            "contact \"outer\".stiffness: m of a contact's p = c g^m is 0.5",
        ),
        (
            &many,
            "load = { pressure = 1.0 }",
            "load = \"equilibrium\"",
            "contact.load = \"equilibrium\" in some; allowed: \"equilibrium\" in all or in none",
        ),
        (
            &many,
            "load = { pressure = 1.0 }",
            "load = -3.0",
            "contact \"outer\".load: the load of a contact is -3; allowed",
        ),
        (&many, "load = { pressure = 1.0 }", "load = { pressures = \"none.csv\" }", "none.csv"),
        (
            &many,
            "[all_contacts]",
            "[[speeds]]\nname = \"slow\"\nfrom = 1.0\nto = 2.0\n[all_contacts]",
            "speeds = given; allowed: cases without all_contacts.speed",
        ),
        (&many, "speed = \"Omega\"\nload_factor", "speed = \"Omga\"\nload_factor", "all_contacts.speed"),
        (
            &many,
            "[all_contacts]",
            "[[forces]]\nname = \"x\"\n[all_contacts]",
            "forces = given; allowed: contacts in equilibrium",
        ),
        (
            &many,
            "elements = \"DISC\"",
            "elements = \"DISK\"",
            "rotation \"disc\".elements = \"DISK\"; allowed: an element set of the mesh",
        ),
        (&many, "density = 7.2e-9", "density = 0.0", "rotation \"disc\": the density is 0; allowed"),
        (&many, "axis = [0.0, 0.0, 3.0]", "axis = [0.0, 0.0, 0.0]", "rotation \"disc\": the axis has the direction"),
        (
            &many,
            "stiffness = 1e5",
            "stiffness = -1.0",
            "springs \"hub x\".stiffness = -1; allowed: a finite number >= 0",
        ),
        (&many, "direction = [1.0, 0.0, 0.0]", "direction = [0.0, 0.0, 0.0]", "springs \"hub x\".direction"),
        (
            &many,
            "symmetry = \"whole\"",
            "symmetry = \"whole\"\nloss_factor = { value = -0.1, at_hz = 3000.0 }",
            "terms \"structure\".loss_factor.value = -0.1",
        ),
        (
            &many,
            "[brake]",
            "[units]\nsystem = \"SI\"\n[brake]",
            "units.system = \"SI\", in which the solids of the mesh have a mean density of 7.200e-9 kg/m^3; allowed: 1e2 to 3e4 kg/m^3, \
             or units.system = \"mm-t-s\"",
        ),
        (
            &many,
            "[brake]",
            "[units]\nsystem = \"mm-kg-s\"\n[brake]",
            "units.system = \"mm-kg-s\"; allowed: \"SI\", \"mm-t-s\"",
        ),
        (
            &in_mm,
            "density = 7.2e-9",
            "density = 7200.0",
            "rotation \"disc\".density = 7.200e3 t/mm^3; allowed: 1e-10 to 3e-8 t/mm^3, or units.system = \"SI\"",
        ),
        (
            &in_mm,
            "speed = \"Omega\"\nload_factor = \"p\"",
            "[[speeds]]\nname = \"slow\"\nfrom = 0.0\nto = 1.0",
            "speeds \"slow\".from = 0; allowed: a speed in mm/s, > 0",
        ),
        (
            &many,
            "symmetry = \"whole\"",
            "symmetry = \"whole\"\nloss_factor = -0.1",
            "terms \"structure\".loss_factor = -0.1; allowed: a finite number >= 0",
        ),
        (
            &many,
            "slave = \"IN\"\nmaster = \"DISC\"",
            "slave = \"LINING\"\nmaster = \"TOP\"",
            "contact \"inner\".slave = a face of the contact \"outer\" too, S1 of element",
        ),
        (
            &many,
            "direction = [1.0, 0.0, 0.0]",
            "to = \"HUB\"\ndirection = [1.0, 0.0, 0.0]",
            "springs \"hub x\".to = the same nodes; allowed: other nodes",
        ),
        // Pads that nothing presses and nothing lifts.
        (&sideways, "[all_contacts]", "[all_contacts]", "108 points are closed is not determined: under loads of"),
        (&balanced, "nodes = \"OUTER\"", "nodes = \"INNER\"", "nothing holds the bodies"),
        (&balanced, "pressure = 1.5", "pressure = -1.5", "there is no equilibrium"),
        (&balanced, "faces = \"OUTER\"", "nodes = \"OUTER\"", "forces \"OUTER\" = other fields; allowed"),
    ];
    let mut wrong = String::new();
    for (text, given, changed, expected) in faults {
        assert!(text.contains(given), "{given}");
        let found = folder.parse(text.replacen(given, changed, if given.starts_with("nodes") { 9 } else { 1 }));
        let found = found.err().unwrap_or("accepted".into());
        if !found.contains(expected) || found.contains('\n') {
            wrong += &format!("{changed}:\n{found}\n");
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}
