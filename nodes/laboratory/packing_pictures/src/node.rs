//! The node itself.

use grainlab_msgs::topics;
use grainlab_node_kit::{
    BULK_LIMIT, BulkSubscription, Bus, BusError, Demand, Health, Next, Node, NodeError, PublisherId, Sample,
    SampleId,
};
use grainlab_pictures::{Drawn, Picture, packing};

/// Packings queued while one is drawn; megabytes each.
const BACKLOG: u32 = 16;

/// Publishes the pictures of each packing that somebody subscribes to, and those of the latest one to a late subscriber.
#[derive(Debug)]
pub struct PackingPictures {
    packings: BulkSubscription,
    latest: Option<Sample>,
    publishers: Vec<PicturePublisher>,
    published: u64,
    trouble: Option<String>,
}

#[derive(Debug)]
struct PicturePublisher {
    picture: Picture,
    publisher: PublisherId,
    shown: Option<SampleId>,
}

impl PackingPictures {
    /// Subscribes to packings, and advertises their pictures.
    ///
    /// # Errors
    /// If a topic is refused.
    pub fn new(bus: &mut dyn Bus) -> Result<Self, BusError> {
        let mut publishers = Vec::new();
        for picture in Picture::ALL {
            publishers.push(PicturePublisher {
                picture,
                publisher: bus.advertise(picture.topic())?,
                shown: None,
            });
        }
        let packings = BulkSubscription::subscribe(bus, &topics::PACKING, Demand::reliable(BACKLOG))?;
        Ok(Self { packings, latest: None, publishers, published: 0, trouble: None })
    }

    /// Publishes the pictures of the latest packing that were not published yet and have readers.
    fn show(&mut self, bus: &mut dyn Bus) -> Result<(), BusError> {
        let Some(latest) = &self.latest else { return Ok(()) };
        let id = latest.info.id();
        let due = |o: &&mut PicturePublisher| o.shown != Some(id) && bus.readers(o.publisher) > 0;
        let due: Vec<&mut PicturePublisher> = self.publishers.iter_mut().filter(due).collect();
        if due.is_empty() {
            return Ok(());
        }
        let packing = match packing(&latest.body) {
            Ok(packing) => packing,
            Err(error) => {
                log::error!("no picture of a packing: {error}");
                bus.count_refused(self.packings.id());
                self.trouble = Some(error.to_string());
                self.latest = None;
                return Ok(());
            }
        };
        self.trouble = None;
        let drawn = Drawn::new(&packing);
        for publisher in due {
            publisher.shown = Some(id);
            let body = publisher.picture.encoded(&drawn);
            let topic = publisher.picture.topic().name;
            if body.len() > BULK_LIMIT {
                let trouble = format!(
                    "{topic} of step {}: {} bytes are too many for one sample: use a recording with grainlab bag \
                     convert --pictures",
                    packing.step,
                    body.len()
                );
                log::warn!("{trouble}");
                self.trouble = Some(trouble);
                continue;
            }
            match bus.publish(publisher.publisher, &body) {
                Ok(_) => self.published += 1,
                // A reader that is far behind gets the next one.
                Err(full @ BusError::Full { .. }) => self.trouble = Some(full.to_string()),
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }
}

impl Node for PackingPictures {
    /// At most one packing, so that each is shown.
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        let taken = self.packings.take(bus)?;
        let again = taken.is_some();
        self.latest = taken.or_else(|| self.latest.take());
        self.show(bus)?;
        Ok(if again { Next::Again } else { Next::Wait(self.packings.patience(bus.now())) })
    }

    fn health(&self) -> Health {
        let health = match &self.trouble {
            Some(trouble) => Health::warn(trouble.clone()),
            None => Health::ok(format!("{} pictures", self.published)),
        };
        health.with("published", self.published).with("waiting", self.packings.waiting())
    }
}
