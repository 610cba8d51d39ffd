//! Contact forces of a LAMMPS `dump local`.
//!
//! The dump does not say what its columns are. They are taken to be those of
//! `compute pl all property/local patom1 patom2` and `compute pf all pair/local dist fx fy fz`:
//! `c_pl[1] c_pl[2]` are the ids, `c_pf[2] c_pf[3] c_pf[4]` the force on the first grain.

use super::assemble::{ListedContact, ListedForce};
use super::error::ImportError;
use super::text::lines;

const COLUMNS: [&str; 5] = ["c_pl[1]", "c_pl[2]", "c_pf[2]", "c_pf[3]", "c_pf[4]"];

/// The contacts of the last frame.
pub(super) fn contacts(text: &str) -> Result<Vec<ListedContact>, ImportError> {
    let mut columns: Option<[usize; 5]> = None;
    let mut contacts = Vec::new();
    for line in lines(text).filter(|l| !l.text.trim().is_empty()) {
        if let Some(item) = line.text.trim().strip_prefix("ITEM:") {
            let names = item.trim().strip_prefix("ENTRIES").map(|n| n.split_whitespace().collect::<Vec<_>>());
            columns = names.map(|names| find(&names).ok_or_else(|| line.error(NEEDED))).transpose()?;
            if columns.is_some() {
                contacts.clear();
            }
        } else if let Some(columns) = columns {
            let words = line.words();
            let field =
                |k: usize| words.get(columns[k]).copied().ok_or_else(|| line.error("a column is missing"));
            contacts.push(ListedContact {
                line: line.number,
                ids: (line.id("first grain", field(0)?)?, line.id("second grain", field(1)?)?),
                normal: None,
                overlap: None,
                force: ListedForce::Total(line.vector("force", [field(2)?, field(3)?, field(4)?])?),
            });
        }
    }
    if columns.is_none() && contacts.is_empty() { Err(ImportError::Empty) } else { Ok(contacts) }
}

const NEEDED: &str = "columns c_pl[1] c_pl[2] c_pf[2] c_pf[3] c_pf[4] are needed: dump local of property/local patom1 patom2 as pl and pair/local dist fx fy fz as pf";

fn find(names: &[&str]) -> Option<[usize; 5]> {
    let [a, b, c, d, e] = COLUMNS.map(|wanted| names.iter().position(|n| *n == wanted));
    Some([a?, b?, c?, d?, e?])
}
