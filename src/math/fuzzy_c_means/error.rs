//! What fuzzy c-means refuses.

use crate::model::fault::Fault;

/// A setting or an input out of its range.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FuzzyError {
    #[error("{found} clusters of {objects} objects")]
    Clusters { found: usize, objects: usize },
    #[error("the fuzzifier is {0}")]
    Fuzzifier(f64),
    #[error("the tolerance is {0}")]
    Tolerance(f64),
    #[error("no iteration is allowed")]
    MaxIterations,
    #[error("attribute {attribute} of object {object} is not a finite number")]
    Object { object: usize, attribute: usize },
    #[error("attribute {attribute} of initial centre {centre} is not a finite number")]
    Centre { centre: usize, attribute: usize },
    #[error("sigma {attribute} is {found}")]
    Sigma { attribute: usize, found: f64 },
    #[error("the inverse covariance of object {object} is not positive definite")]
    Inverse { object: usize },
    #[error("'{field}' has {found} values")]
    Length {
        field: &'static str,
        found: usize,
        wanted: &'static str,
    },
    #[error("the {field} is {found}")]
    Search {
        field: &'static str,
        found: f64,
        allowed: &'static str,
    },
}

impl FuzzyError {
    /// The name of the input at fault.
    pub fn field(&self) -> &'static str {
        match self {
            FuzzyError::Clusters { .. } => "clusters",
            FuzzyError::Fuzzifier(_) => "fuzzifier",
            FuzzyError::Tolerance(_) => "tolerance",
            FuzzyError::MaxIterations => "max_iterations",
            FuzzyError::Object { .. } => "objects",
            FuzzyError::Centre { .. } => "initial",
            FuzzyError::Sigma { .. } => "sigmas",
            FuzzyError::Inverse { .. } => "inverses",
            FuzzyError::Length { field, .. } | FuzzyError::Search { field, .. } => field,
        }
    }

    /// What would have been accepted.
    pub fn allowed(&self) -> String {
        match self {
            FuzzyError::Clusters { objects, .. } => {
                format!("[2, {objects}], the number of objects")
            }
            FuzzyError::Fuzzifier(_) => "> 1".to_owned(),
            FuzzyError::Tolerance(_) | FuzzyError::Sigma { .. } => "> 0".to_owned(),
            FuzzyError::MaxIterations => ">= 1".to_owned(),
            FuzzyError::Object { .. } | FuzzyError::Centre { .. } => "finite numbers".to_owned(),
            FuzzyError::Inverse { .. } => "symmetric, positive definite matrices".to_owned(),
            FuzzyError::Length { wanted, .. } => (*wanted).to_owned(),
            FuzzyError::Search { allowed, .. } => (*allowed).to_owned(),
        }
    }

    /// The same as a fault of the request whose object at `pointer` has the field.
    pub fn fault(&self, pointer: &str) -> Fault {
        Fault::new(
            format!("{pointer}/{}", self.field()),
            "out_of_range",
            self.to_string(),
        )
        .allowing(self.allowed())
    }
}
