//! Means over the rows of a table that are alike.

use super::Dataset;
use crate::mean::Mean;
use grainlab_console::Cell;
use std::collections::BTreeMap;

impl Dataset {
    /// One row for each combination of the columns `by`, in the order of the first rows: these columns, the number `n` of rows,
    /// and `KEY_mean` and `KEY_standard_error` of every column of numbers except `without`, over the rows in which it is
    /// known. A column that is known in some rows only has their number as `KEY_n`.
    #[must_use]
    pub fn means(&self, by: &[&str], without: &[&str]) -> Self {
        let at = |name: &&str| self.names.iter().position(|n| n == name);
        let by: Vec<usize> = by.iter().filter_map(at).collect();
        let (mut places, mut groups) = (BTreeMap::new(), Vec::<Vec<&Vec<Cell>>>::new());
        for row in &self.rows {
            let key: Vec<String> = by.iter().map(|c| row[*c].text()).collect();
            let place = *places.entry(key).or_insert(groups.len());
            groups.resize_with(groups.len().max(place + 1), Vec::new);
            groups[place].push(row);
        }
        let mut means = Self::new(by.iter().map(|c| self.names[*c].clone()).chain(["n".to_owned()]));
        for group in &groups {
            let key = by.iter().map(|c| group[0][*c].clone());
            means.row(key.chain([Cell::Count(group.len() as u64)]));
        }
        for (c, name) in self.names.iter().enumerate() {
            let is_other = |row: &Vec<Cell>| matches!(row[c], Cell::Text(_) | Cell::Flag(_));
            if by.contains(&c) || without.contains(&name.as_str()) || self.rows.iter().any(is_other) {
                continue;
            }
            let of = |group: &Vec<&Vec<Cell>>| Mean::of(group.iter().filter_map(|row| number_of(&row[c])));
            let found: Vec<Option<Mean>> = groups.iter().map(of).collect();
            let count = |m: &Option<Mean>| m.map_or(0, |m| m.count);
            let is_partial = found.iter().zip(&groups).any(|(m, group)| count(m) < group.len());
            let mut names = vec![format!("{name}_mean"), format!("{name}_standard_error")];
            names.extend(is_partial.then(|| format!("{name}_n")));
            let number = |v: Option<f64>| v.map_or(Cell::Unknown, Cell::Number);
            let [value, error] = [|m: Mean| Some(m.value), |m: Mean| m.error];
            let of = |m: &Option<Mean>| [number(m.and_then(value)), number(m.and_then(error))].to_vec();
            means.extend(names, found.iter().map(|m| [of(m), vec![Cell::Count(count(m) as u64)]].concat()));
        }
        means
    }
}

fn number_of(cell: &Cell) -> Option<f64> {
    match cell {
        Cell::Number(v) => Some(*v).filter(|v| v.is_finite()),
        Cell::Count(n) => Some(*n as f64),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_alike_have_a_mean_with_its_standard_error_of_what_is_known() {
        let mut t = Dataset::new(["name", "seed", "mu", "z", "g"].map(str::to_owned));
        for (seed, mu, z, g) in [(1, 0.1, 4.0, f64::NAN), (2, 0.1, 6.0, 2.0), (1, 0.3, 5.0, 1.5)] {
            let numbers = [mu, z, g].map(Cell::Number);
            t.row([Cell::Text("x".into()), Cell::Count(seed)].into_iter().chain(numbers));
        }
        let expected =
            "mu,n,z_mean,z_standard_error,g_mean,g_standard_error,g_n\n0.1,2,5,1,2,,1\n0.3,1,5,,1.5,,1\n";
        assert_eq!(t.means(&["mu"], &["seed"]).csv(), expected);
    }
}
