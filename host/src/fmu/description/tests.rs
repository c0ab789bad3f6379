use super::*;

/// A description with the given variables, for tests elsewhere too.
pub(crate) fn description(variables: Vec<Variable>) -> Description {
    let index = variables
        .iter()
        .enumerate()
        .map(|(i, v)| (v.name.clone(), i))
        .collect();
    Description {
        version: Version::V3,
        fmi_version: "3.0".into(),
        model_name: "m".into(),
        token: String::new(),
        description: String::new(),
        model_version: String::new(),
        author: String::new(),
        license: String::new(),
        generation_tool: String::new(),
        generation_date: String::new(),
        model_exchange: false,
        scheduled_execution: false,
        co_simulation: Some(CoSimulation::default()),
        default_experiment: DefaultExperiment::default(),
        log_categories: Vec::new(),
        variables,
        units: Units::new(),
        dependencies: Dependencies::new(),
        problems: Vec::new(),
        index,
    }
}

pub(crate) fn variable(name: &str, causality: Causality) -> Variable {
    Variable {
        name: name.into(),
        reference: 0,
        kind: Kind::Float64,
        causality,
        constant: false,
        settable: matches!(causality, Causality::Parameter | Causality::Input),
        unit: None,
        min: None,
        max: None,
        start: Vec::new(),
        dimensions: Vec::new(),
        sized_by: Vec::new(),
        description: String::new(),
        items: Vec::new(),
    }
}

#[test]
fn elements_are_addressed_in_row_major_order() {
    let mut array = variable("a", Causality::Parameter);
    array.dimensions = vec![2, 3];
    let d = description(vec![variable("b", Causality::Input), array]);
    let scalar = |variable, element| Ok(Scalar { variable, element });
    assert_eq!(d.scalar("b"), scalar(0, 0));
    assert_eq!(d.scalar("a[1,1]"), scalar(1, 0));
    assert_eq!(d.scalar("a[2,1]"), scalar(1, 3));
    assert_eq!(d.scalar("a[2, 3]"), scalar(1, 5));
    for wrong in [
        "a[0,1]", "a[3,1]", "a[1]", "a[1,1,1]", "a[x,1]", "b[1]", "c",
    ] {
        assert!(
            matches!(d.scalar(wrong), Err(NameError::Unknown { .. })),
            "{wrong}"
        );
    }
    assert!(matches!(d.scalar("a"), Err(NameError::Array { .. })));
    for element in 0..6 {
        let scalar = Scalar {
            variable: 1,
            element,
        };
        assert_eq!(d.scalar(&d.name_of(scalar)), Ok(scalar));
    }
}

#[test]
fn arrays_follow_their_structural_parameter() {
    let mut points = variable("points", Causality::StructuralParameter);
    (points.kind, points.reference) = (Kind::UInt64, 9);
    let mut array = variable("a", Causality::Output);
    (array.dimensions, array.sized_by) = (vec![2, 3], vec![None, Some(9)]);
    let d = description(vec![points, array]);
    let points = d.scalar("points").unwrap();
    let resized = d.resized(&[(points, Value::Integer(5))]);
    assert_eq!(resized.variables[1].dimensions, [2, 5]);
    assert!(resized.scalar("a[2,5]").is_ok() && d.scalar("a[2,5]").is_err());
}

#[test]
fn absurd_dimensions_are_no_length() {
    let mut array = variable("a", Causality::Parameter);
    for (dimensions, elements) in [
        (vec![], Some(1)),
        (vec![1 << 10, 1 << 10], Some(1 << 20)),
        (vec![1 << 10, (1 << 10) + 1], None),
        (vec![90_000_000_000], None),
        (vec![1 << 32, 1 << 32], None),
        (vec![usize::MAX, 2, 0], None),
    ] {
        array.dimensions = dimensions;
        assert_eq!(array.elements(), elements, "{:?}", array.dimensions);
    }
}

#[test]
fn one_start_value_serves_all_elements() {
    let mut array = variable("a", Causality::Parameter);
    array.dimensions = vec![2];
    array.start = vec!["4".into()];
    assert_eq!(array.start_of(1), Some(Value::Float(4.0)));
    array.start = vec!["4".into(), "5".into()];
    assert_eq!(array.start_of(1), Some(Value::Float(5.0)));
}
