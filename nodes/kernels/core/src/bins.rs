//! Grains sorted into bins.

/// The grains of bin b are `members[first[b]..first[b + 1]]`, in ascending order: `(first, members)`, with the bin of each grain
/// below `bins`. There are fewer than 2³² grains.
pub fn sorted_into_bins(bins: usize, bin_of: impl Iterator<Item = usize> + Clone) -> (Vec<u32>, Vec<u32>) {
    let mut first = vec![0u32; bins + 1];
    bin_of.clone().for_each(|bin| first[bin + 1] += 1);
    for bin in 0..bins {
        first[bin + 1] += first[bin];
    }
    let mut next = first.clone();
    let mut members = vec![0; first[bins] as usize];
    for (grain, bin) in bin_of.enumerate() {
        members[next[bin] as usize] = grain as u32;
        next[bin] += 1;
    }
    (first, members)
}

#[cfg(test)]
mod tests {
    #[test]
    fn each_bin_has_its_grains_in_ascending_order() {
        let (first, members) = super::sorted_into_bins(4, [2, 0, 2, 3, 0].into_iter());
        assert_eq!((first, members), (vec![0, 2, 2, 4, 5], vec![1, 4, 0, 2, 3]));
    }
}
