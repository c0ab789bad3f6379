use crate::tree::ModelDescription;
use crate::xml::Reader;
pub(super) fn check(_: &ModelDescription, _: &mut Reader) {}
