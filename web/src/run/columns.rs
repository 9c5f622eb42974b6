//! Views and stations cross from worker to page as columns of numbers: as objects of JavaScript, the
//! thousands of a large scan would keep the page's thread busy.

use serde::{Deserialize, Serialize};
use snellius::export::Status;

use super::packed::{self, Packed};
use super::report::{Place, Spot, Stand, StationFacts, ViewOutcome};

/// For [`super::report::Piece::Views`].
pub(super) mod views {
    use super::{ViewColumns, ViewOutcome};
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(in crate::run) fn serialize<S: Serializer>(
        views: &[ViewOutcome],
        to: S,
    ) -> Result<S::Ok, S::Error> {
        ViewColumns::of(views).serialize(to)
    }

    pub(in crate::run) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<Vec<ViewOutcome>, D::Error> {
        Ok(ViewColumns::deserialize(from)?.views())
    }
}

/// For [`super::report::Piece::Stations`].
pub(super) mod stations {
    use super::{StationColumns, StationFacts};
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(in crate::run) fn serialize<S: Serializer>(
        stations: &[StationFacts],
        to: S,
    ) -> Result<S::Ok, S::Error> {
        StationColumns::of(stations).serialize(to)
    }

    pub(in crate::run) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<Vec<StationFacts>, D::Error> {
        Ok(StationColumns::deserialize(from)?.stations())
    }
}

/// What views gave: one after the other in every column.
#[derive(Default, Serialize, Deserialize)]
struct ViewColumns {
    #[serde(with = "packed")]
    heads: Vec<ViewHead>,
    #[serde(with = "packed")]
    spots: Vec<Spot>,
    /// Beam and sight of each view.
    #[serde(with = "packed")]
    light: Vec<Place>,
    /// Why views have no object point: the view, and the reason.
    reasons: Vec<(usize, String)>,
    /// Why spots were refused: the view, the spot, and the reason.
    spot_reasons: Vec<(usize, usize, String)>,
}

/// How much of the columns is a view's.
struct ViewHead {
    status: Status,
    points: std::ops::Range<usize>,
    spots: usize,
    beam: usize,
    sight: usize,
}

impl ViewColumns {
    fn of(views: &[ViewOutcome]) -> Self {
        let mut columns = Self::default();
        for (number, view) in views.iter().enumerate() {
            columns.heads.push(ViewHead {
                status: view.status,
                points: view.points.clone(),
                spots: view.spots.len(),
                beam: view.beam.len(),
                sight: view.sight.len(),
            });
            columns.spots.extend(&view.spots);
            columns.light.extend(view.beam.iter().chain(&view.sight));
            let reason = view.reason.iter().map(|reason| (number, reason.clone()));
            columns.reasons.extend(reason);
            let of_spots = view.reasons.iter();
            let of_spots = of_spots.map(|(spot, reason)| (number, *spot, reason.clone()));
            columns.spot_reasons.extend(of_spots);
        }
        columns
    }

    fn views(self) -> Vec<ViewOutcome> {
        let (mut spots, mut light) = (self.spots.into_iter(), self.light.into_iter());
        let of_head = |head: ViewHead| ViewOutcome {
            status: head.status,
            reason: None,
            spots: spots.by_ref().take(head.spots).collect(),
            reasons: Vec::new(),
            points: head.points,
            beam: light.by_ref().take(head.beam).collect(),
            sight: light.by_ref().take(head.sight).collect(),
        };
        let mut views: Vec<ViewOutcome> = self.heads.into_iter().map(of_head).collect();
        for (view, reason) in self.reasons {
            views[view].reason = Some(reason);
        }
        for (view, spot, reason) in self.spot_reasons {
            views[view].reasons.push((spot, reason));
        }
        views
    }
}

impl Packed for ViewHead {
    const COUNT: usize = 6;

    fn pack(&self, numbers: &mut Vec<f32>) {
        let status = match self.status {
            Status::Ok => 0.0,
            Status::NoVesselSpot => 1.0,
            Status::NoObjectSpot => 2.0,
            Status::Rejected => 3.0,
        };
        numbers.push(status);
        // Single precision counts to sixteen million.
        let counts = [
            self.points.start,
            self.points.end,
            self.spots,
            self.beam,
            self.sight,
        ];
        numbers.extend(counts.map(|count| count as f32));
    }

    fn unpack(n: &[f32]) -> Self {
        Self {
            status: match n[0] {
                0.0 => Status::Ok,
                1.0 => Status::NoVesselSpot,
                2.0 => Status::NoObjectSpot,
                _ => Status::Rejected,
            },
            points: n[1] as usize..n[2] as usize,
            spots: n[3] as usize,
            beam: n[4] as usize,
            sight: n[5] as usize,
        }
    }
}

/// Stations, likewise.
#[derive(Serialize, Deserialize)]
struct StationColumns {
    ids: Vec<String>,
    #[serde(with = "packed")]
    places: Vec<StationPlace>,
}

/// A station without its name.
struct StationPlace {
    sweep: usize,
    stand: Option<Stand>,
}

impl StationColumns {
    fn of(stations: &[StationFacts]) -> Self {
        let place = |station: &StationFacts| StationPlace {
            sweep: station.sweep,
            stand: station.stand,
        };
        Self {
            ids: stations.iter().map(|station| station.id.clone()).collect(),
            places: stations.iter().map(place).collect(),
        }
    }

    fn stations(self) -> Vec<StationFacts> {
        let stations = self.ids.into_iter().zip(self.places);
        let station = |(id, place): (String, StationPlace)| StationFacts {
            id,
            sweep: place.sweep,
            stand: place.stand,
        };
        stations.map(station).collect()
    }
}

impl Packed for StationPlace {
    const COUNT: usize = 2 + 8 * Place::COUNT;

    fn pack(&self, numbers: &mut Vec<f32>) {
        numbers.push(self.sweep as f32);
        numbers.push(f32::from(u8::from(self.stand.is_some())));
        let places = self.stand.map_or([[0.0; 3]; 8], |stand| {
            let [a, b, c, d] = stand.corners;
            let Stand {
                camera,
                laser,
                down,
                ahead,
                ..
            } = stand;
            [camera, a, b, c, d, laser, down, ahead]
        });
        places.iter().for_each(|place| place.pack(numbers));
    }

    fn unpack(n: &[f32]) -> Self {
        let place = |number: usize| Place::unpack(&n[2 + number * Place::COUNT..]);
        Self {
            sweep: n[0] as usize,
            stand: (n[1] == 1.0).then(|| Stand {
                camera: place(0),
                corners: [place(1), place(2), place(3), place(4)],
                laser: place(5),
                down: place(6),
                ahead: place(7),
            }),
        }
    }
}

impl Packed for Place {
    const COUNT: usize = 3;

    fn pack(&self, numbers: &mut Vec<f32>) {
        numbers.extend(self.map(|part| part as f32));
    }

    fn unpack(n: &[f32]) -> Self {
        [n[0], n[1], n[2]].map(f64::from)
    }
}
