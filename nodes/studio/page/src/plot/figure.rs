//! The contents of a plot.

/// A plot: series over two axes, and a legend. On a page without one, the names of the series stand at their ends or above.
#[derive(Clone, Debug, Default)]
pub struct Figure {
    /// Title of the plot.
    pub title: String,
    /// Line below the title.
    pub subtitle: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// In the order of drawing: later ones are on top.
    pub series: Vec<Series>,
    /// The legend, from top to bottom.
    pub legend: Vec<Entry>,
}

/// One axis; its range is that of the values.
#[derive(Clone, Debug, Default)]
pub struct Axis {
    /// Name and unit.
    pub name: String,
    /// Spacing of the values.
    pub scale: Scale,
}

impl Axis {
    /// A linear axis.
    pub fn linear(name: impl Into<String>) -> Self {
        Self { name: name.into(), scale: Scale::Linear }
    }

    /// A logarithmic axis. Values that are not positive are left out.
    pub fn log(name: impl Into<String>) -> Self {
        Self { name: name.into(), scale: Scale::Log }
    }
}

/// The spacing of the values of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// Equal differences are equal distances.
    #[default]
    Linear,
    /// Equal ratios are equal distances.
    Log,
}

/// Points of one colour and shape.
#[derive(Clone, Debug, Default)]
pub struct Series {
    /// Name in the legend, or beside the end of the line; empty for a series without one.
    pub name: String,
    /// Number of the colour; see [`Series::COLOURS`]. `None` for grey.
    pub colour: Option<usize>,
    /// Shape of the points; `None` for a line alone.
    pub marker: Option<Marker>,
    /// True for points drawn as outlines.
    pub hollow: bool,
    /// The line through the points, if any.
    pub line: Option<Line>,
    /// The points, in the order of the line.
    pub points: Vec<Point>,
}

impl Series {
    /// Number of different colours; higher numbers start over.
    pub const COLOURS: usize = 9;

    pub(super) fn entry(&self) -> Entry {
        match (self.marker, self.colour) {
            (None, Some(colour)) => Entry::Colour(colour, self.name.clone()),
            (marker, colour) => {
                Entry::Shape(marker.unwrap_or(Marker::Circle), colour, self.hollow, self.name.clone())
            }
        }
    }
}

/// One point of a series.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Point {
    /// Value on the horizontal axis.
    pub x: f64,
    /// Value on the vertical axis.
    pub y: f64,
    /// Half length of the vertical error bar.
    pub error: Option<f64>,
    /// Text of its tooltip.
    pub tooltip: Option<String>,
    /// Label, left out if there is no room.
    pub label: Option<String>,
}

impl Point {
    /// A point with nothing else.
    pub fn at(x: f64, y: f64) -> Self {
        Self { x, y, ..Self::default() }
    }

    pub(super) fn up(&self) -> [f64; 3] {
        let error = self.error.unwrap_or(0.0);
        [self.y, self.y - error, self.y + error]
    }
}

/// Shape of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    /// A filled disc.
    Circle,
    /// A square standing on a side.
    Square,
    /// A triangle standing on a side.
    Triangle,
    /// A square standing on a corner.
    Diamond,
    /// A triangle standing on a corner.
    TriangleDown,
    /// A regular pentagon.
    Pentagon,
    /// A regular hexagon.
    Hexagon,
}

impl Marker {
    /// A shape for each of several sets; higher numbers start over.
    pub fn of(set: usize) -> Self {
        const SHAPES: [Marker; 7] = [
            Marker::Circle,
            Marker::Square,
            Marker::Triangle,
            Marker::Diamond,
            Marker::TriangleDown,
            Marker::Pentagon,
            Marker::Hexagon,
        ];
        SHAPES[set % SHAPES.len()]
    }
}

/// The line between points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Line {
    /// By straight lines.
    Straight,
    /// By faint straight lines that only guide the eye.
    Faint,
}

/// One line of the legend.
#[derive(Clone, Debug, PartialEq)]
pub enum Entry {
    /// A colour with its meaning.
    Colour(usize, String),
    /// A shape, filled or hollow, in a colour or grey.
    Shape(Marker, Option<usize>, bool, String),
    /// Text without a symbol.
    Note(String),
    /// An empty line.
    Gap,
}

/// Colours of a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Theme {
    /// Dark on white.
    #[default]
    Light,
    /// That of the reader's system.
    System,
}
