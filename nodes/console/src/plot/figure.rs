//! What is drawn.

/// A plot: series over two axes, and a legend beside them.
#[derive(Clone, Debug, Default)]
pub struct Figure {
    /// In large letters above.
    pub title: String,
    /// What explains it, below the title.
    pub subtitle: String,
    /// From left to right.
    pub x: Axis,
    /// From bottom to top.
    pub y: Axis,
    /// Drawn in this order: later ones lie on top.
    pub series: Vec<Series>,
    /// From top to bottom.
    pub legend: Vec<Entry>,
}

/// One axis; its range is that of the values.
#[derive(Clone, Debug, Default)]
pub struct Axis {
    /// Name and unit.
    pub name: String,
    /// How values are spaced.
    pub scale: Scale,
}

impl Axis {
    /// A linear axis.
    pub fn linear(name: impl Into<String>) -> Self {
        Self { name: name.into(), scale: Scale::Linear }
    }

    /// A logarithmic axis. What is not above zero is left out.
    pub fn log(name: impl Into<String>) -> Self {
        Self { name: name.into(), scale: Scale::Log }
    }
}

/// How the values of an axis are spaced.
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
    /// Number of the colour; see [`Series::COLOURS`]. `None` for grey.
    pub colour: Option<usize>,
    /// Shape of the points; `None` for a line alone.
    pub marker: Option<Marker>,
    /// Whether points are drawn as outlines.
    pub hollow: bool,
    /// The line through them, if there is one.
    pub line: Option<Line>,
    /// In the order of the line.
    pub points: Vec<Point>,
}

impl Series {
    /// Colours that differ from one another; higher numbers begin anew.
    pub const COLOURS: usize = 9;
}

/// One point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Point {
    /// Along the horizontal axis.
    pub x: f64,
    /// Along the vertical axis.
    pub y: f64,
    /// Half length of the vertical error bar.
    pub error: Option<f64>,
    /// What it is, shown where the pointer rests on it.
    pub tooltip: Option<String>,
    /// Text beside it, left out where there is no room.
    pub label: Option<String>,
}

impl Point {
    /// A point without anything else.
    pub fn at(x: f64, y: f64) -> Self {
        Self { x, y, ..Self::default() }
    }

    pub(super) fn across(&self) -> [f64; 1] {
        [self.x]
    }

    pub(super) fn up(&self) -> [f64; 3] {
        let error = self.error.unwrap_or(0.0);
        [self.y, self.y - error, self.y + error]
    }
}

/// A shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    /// A disc.
    Circle,
    /// A square on its side.
    Square,
    /// A triangle on its side.
    Triangle,
    /// A square on its corner.
    Diamond,
    /// A triangle on its corner.
    TriangleDown,
    /// A pentagon.
    Pentagon,
    /// A hexagon.
    Hexagon,
    /// A large red star, for the one point that others are compared with.
    Star,
}

impl Marker {
    /// A shape for each of several sets; higher numbers begin anew.
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

/// How points are joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Line {
    /// By straight lines.
    Straight,
    /// By straight lines so faint that they only guide the eye.
    Faint,
    /// By steps, first across and then up or down.
    Steps,
}

/// One line of the legend.
#[derive(Clone, Debug, PartialEq)]
pub enum Entry {
    /// A colour.
    Colour(usize, String),
    /// A shape, filled or hollow, in a colour or grey.
    Shape(Marker, Option<usize>, bool, String),
    /// Words alone.
    Note(String),
    /// Nothing.
    Gap,
}

/// The paper.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Theme {
    /// Dark on white.
    #[default]
    Light,
    /// Light on dark.
    Dark,
    /// Whichever of both the reader's system asks for.
    System,
}
