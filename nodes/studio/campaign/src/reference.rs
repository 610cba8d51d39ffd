//! The reference of the file of a campaign as a page of Markdown, written from the tables of keys.

use crate::file::KEYS;

const INTRODUCTION: &str = include_str!("reference/introduction.md");

/// The page: how campaigns are written, and every key with its values and default.
pub fn reference() -> String {
    let table = |in_groups: bool| {
        let keys = KEYS.iter().filter(|k| k.in_groups == in_groups);
        let rows = keys.map(|k| format!("| `{}` | {} | {} | {} |\n", k.name, k.form, k.default, k.meaning));
        format!("\n\n| key | values | default | meaning |\n|---|---|---|---|\n{}", rows.collect::<String>())
    };
    let [campaign, runs] = [table(false), table(true)];
    format!("{INTRODUCTION}\n## The campaign{campaign}\n## Runs, also those of each `[[group]]`{runs}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::Campaign;
    use std::path::Path;

    /// The page beside the campaigns is written from the tables. With `GRAINLAB_BLESS=1` the test writes it.
    #[test]
    fn the_page_beside_the_campaigns_is_that_of_the_tables() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/campaigns/README.md");
        if std::env::var_os("GRAINLAB_BLESS").is_some() {
            std::fs::write(path, reference()).unwrap();
        }
        let bless = "GRAINLAB_BLESS=1 cargo test --release -p grainlab_campaign page_beside";
        let page = std::fs::read_to_string(path).unwrap();
        assert!(page == reference(), "{path} is out of date: {bless} writes it");
    }

    #[test]
    fn the_example_of_the_page_holds() {
        let example = INTRODUCTION.split("```").nth(1).and_then(|text| text.strip_prefix("toml\n")).unwrap();
        let members = Campaign::parse(example, Path::new("/nowhere")).unwrap().members;
        assert_eq!((members.len(), members[31].name.as_str()), (32, "s3-7"));
        assert_eq!(members[0].name, "demo-friction=0.05-drag=1000-pressure=50000-1");
    }
}
