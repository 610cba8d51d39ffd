//! A whole table: read in pieces, inverted in parallel, written in order.

use super::answer::{Answer, More};
use super::columns::Row;
use super::print::Printer;
use super::rows::Rows;
use grainlab_console::{Failure, Format, json_element, print_more, say, worse};
use grainlab_node_kit::Exit;
use std::time::Instant;

/// Maximum number of states printed as a text table, whose columns are aligned at its end.
const FOR_PEOPLE: usize = 1000;

#[derive(Debug)]
pub(super) struct Tally {
    rows: u64,
    bad: u64,
    /// The word for rows whose exit is not 0.
    word: &'static str,
    exit: Exit,
    begin: Instant,
}

impl Tally {
    pub(super) fn new(word: &'static str) -> Self {
        Self { rows: 0, bad: 0, word, exit: Exit::Done, begin: Instant::now() }
    }

    pub(super) fn add(&mut self, exit: Exit, complaint: &str) {
        self.rows += 1;
        self.bad += u64::from(exit != Exit::Done);
        self.exit = worse(self.exit, exit);
        if !complaint.is_empty() {
            say!("{complaint}");
        }
    }

    /// Ends with `exit` if no row has an estimate.
    pub(super) fn unsolved(&mut self, rows: usize, exit: Exit) {
        if rows as u64 == self.rows - self.bad {
            self.exit = worse(self.exit, exit);
        }
    }

    pub(super) fn end(self, table: &Rows) -> Result<Exit, Failure> {
        let left_out = table.left_out();
        if self.rows == 0 {
            let name = table.name();
            return Err(Failure::usage(format!("{name}: there is no state below the header{left_out}")));
        }
        let seconds = self.begin.elapsed().as_secs_f64();
        say!(
            "grainlab: {}, {} {}{left_out}, {seconds:.1} s",
            grainlab_console::count(self.rows, "row"),
            self.bad,
            self.word
        );
        Ok(self.exit)
    }
}

pub(super) fn run(mut rows: Rows, printer: &Printer<'_>, format: Format) -> Result<Exit, Failure> {
    let answer = |number, row: Result<Row, _>| match row {
        Ok(row) => Answer::of(row.state, Some(number), printer.cases),
        Err(bad) => Answer::of_bad_row(bad, number),
    };
    let mut tally = Tally::new("bad");
    let mut kept = Vec::new();
    // Between two texts, before the first, and without any.
    let (separator, start, nothing) = match format {
        Format::Json => (",", "[".to_owned(), "[]\n"),
        Format::Csv => ("", Printer::csv_header(), ""),
        Format::Table => ("", String::new(), ""),
    };
    let mut begun = false;
    loop {
        // Text is formatted in the same threads, because formatting takes as long as the inversion.
        let piece = rows.next(|number, row| {
            let answer = answer(number, row);
            let text = match format {
                Format::Csv => printer.csv(&answer),
                Format::Json => json_element(&answer.view(printer.cases, More::default()))?,
                Format::Table => String::new(),
            };
            let exit = answer.exit(printer.cases);
            let complaint = if exit == Exit::Done { String::new() } else { answer.complaint(printer.cases) };
            // Only a text table collects all results before printing.
            Ok::<_, Failure>((text, exit, complaint, (format == Format::Table).then_some(answer)))
        })?;
        let Some(piece) = piece else { break };
        let mut texts = Vec::with_capacity(piece.len());
        for found in piece {
            let (text, exit, complaint, answer) = found?;
            tally.add(exit, &complaint);
            texts.push(text);
            kept.extend(answer);
        }
        if kept.len() > FOR_PEOPLE {
            let most = format!("more than {FOR_PEOPLE} states are too many for a text table");
            return Err(Failure::usage(format!("{}: {most}; use --format csv or json", rows.name())));
        }
        if texts.is_empty() {
            continue;
        }
        let before = if std::mem::replace(&mut begun, true) { separator } else { &start };
        if !print_more(&format!("{before}{}", texts.join(separator)))? {
            // The reader closed the pipe.
            return Ok(tally.exit);
        }
    }
    if format == Format::Table && tally.rows > 0 {
        print_more(&printer.people(&kept))?;
    }
    let ended = tally.end(&rows);
    let end = if format == Format::Json && begun { "\n]\n" } else { "" };
    print_more(if begun { end } else { nothing })?;
    ended
}
