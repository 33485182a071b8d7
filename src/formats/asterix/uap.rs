//! Which items the records of a category have, in the order of their field references. Made from asterix-specs c2b3d67
//! (BSD-3-Clause, `docs/licenses/BSD-3-Clause-asterix-specs.txt`).
//!
//! `NAME=shape`, of which a number is a fixed length; `x` and `f` end with an octet whose last bit is 0; `r1:N` is a
//! count, then N octets each; `c(..)` has presence bits of its own; `e` begins with its length; `-` is unused; `rfs` is
//! random field sequencing.

use super::shape::{Field, fields};

const PLOTS_001: &str = "\
    010=2 020=x 040=4 070=2 090=2 130=f 141=2 050=2 120=1 131=1 080=2 100=4 060=2 030=f \
    150=1 - - - - SP=e rfs";
const TRACKS_001: &str = "\
    010=2 020=x 161=2 040=4 042=4 200=4 070=2 090=2 141=2 130=f 131=1 120=1 170=x 210=f \
    050=2 080=2 100=4 060=2 030=f SP=e rfs 150=1";
const CAT_002: &str = "\
    010=2 000=1 020=1 030=3 041=2 050=f 060=f 070=r1:2 100=8 090=2 080=f - SP=e rfs";
const CAT_010: &str = "\
    010=2 000=1 020=x 140=3 041=8 040=4 042=4 200=4 202=4 161=2 170=x 060=2 220=3 245=7 \
    250=r1:8 300=1 090=2 091=2 270=x 550=1 310=1 500=4 280=r1:2 131=1 210=2 - SP=e RE=e";
const CAT_011: &str = "\
    010=2 000=1 015=1 140=3 041=8 042=4 202=4 210=2 060=2 245=7 \
    380=c(r1:8,3,-,3,-,-,-,4,1,-,1) 161=2 170=x 290=c(1,1,1,1,1,2,1,1,1,1,1,1) 430=1 090=2 \
    093=2 092=2 215=2 270=x 390=c(2,7,4,1,4,1,4,4,3,2,2,r1:4,6,1) 300=1 310=1 \
    500=c(2,4,2,2,2,2) 600=3 605=r1:2 610=r1:2 SP=e RE=e";
const CAT_020: &str = "\
    010=2 020=x 140=3 041=8 042=6 161=2 170=x 070=2 202=4 090=2 100=4 220=3 245=7 110=2 \
    105=2 210=2 300=1 310=1 500=c(6,6,2) 400=r1:1 250=r1:8 230=2 260=7 030=f 055=1 050=2 \
    RE=e SP=e";
const CAT_021: &str = "\
    010=2 040=x 161=2 015=1 071=3 130=6 131=8 072=3 150=2 151=2 080=3 073=3 074=4 075=3 \
    076=4 140=2 090=x 210=1 070=2 230=2 145=2 152=2 200=1 155=2 157=2 160=4 165=2 077=3 \
    170=6 020=1 220=c(2,2,2,1) 146=2 148=2 110=c(x1,r1:15) 016=1 008=1 271=x 132=1 \
    250=r1:8 260=7 400=1 295=c(1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1) - - - - - \
    RE=e SP=e";
const CAT_021_0: &str = "\
    010=2 040=2 030=3 130=8 080=3 140=2 090=2 210=1 230=2 145=2 150=2 151=2 152=2 155=2 \
    157=2 160=4 165=x 170=6 095=1 032=1 200=1 020=1 220=c(2,2,2,1) 146=2 148=2 \
    110=c(x1,r1:15) 070=2 131=1 - - - - - RE=e SP=e";
const CAT_034: &str = "\
    010=2 000=1 030=3 020=1 041=2 050=c(1,-,-,1,1,2) 060=c(1,-,-,1,1,1) 070=r1:2 100=8 \
    110=1 120=8 090=2 RE=e SP=e";
const CAT_048: &str = "\
    010=2 140=3 020=x 040=4 070=2 090=2 130=c(1,1,1,1,1,1,1) 220=3 240=6 250=r1:8 161=2 \
    042=4 200=4 170=x 210=4 030=f 080=2 100=4 110=2 120=c(2,r1:6) 230=2 260=7 055=1 050=2 \
    065=1 060=2 SP=e RE=e";
const CAT_062: &str = "\
    010=2 - 015=1 070=3 105=8 100=6 185=4 210=2 060=2 245=7 380=c(3,6,2,2,2,2,2,x1,r1:15,\
    2,2,7,2,2,2,2,2,2,1,8,1,6,2,1,r1:8,2,2,2) 040=2 080=x 290=c(1,1,1,1,2,1,1,1,1,1) 200=1 \
    295=c(1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1) 136=2 130=2 135=2 \
    220=2 390=c(2,7,4,1,4,1,4,4,3,2,2,r1:4,6,1,7,7,2,7) 270=x 300=1 110=c(1,4,6,2,2,1,1) \
    120=2 510=f 500=c(4,2,4,1,1,2,2,1) 340=c(2,4,2,2,2,1) - - - - - RE=e SP=e";
const CAT_065: &str = "\
    010=2 000=1 015=1 030=3 020=1 040=1 050=1 - - - - - RE=e SP=e";

/// A category in an edition, and what others read alike.
pub struct Edition {
    pub category: u8,
    pub name: &'static str,
    /// Older ones that this table reads, too.
    pub reads: &'static [&'static str],
    fields: &'static str,
    /// Where the first bit of item 020 decides: fields of a track.
    fields_of_track: Option<&'static str>,
}

const fn edition(
    category: u8,
    name: &'static str,
    reads: &'static [&'static str],
    fields: &'static str,
) -> Edition {
    Edition {
        category,
        name,
        reads,
        fields,
        fields_of_track: None,
    }
}

/// Every edition; of a category the newest comes first, and is the default.
pub const EDITIONS: &[Edition] = &[
    Edition {
        fields_of_track: Some(TRACKS_001),
        ..edition(1, "1.4", &["1.2", "1.3"], PLOTS_001)
    },
    edition(2, "1.2", &["1.0", "1.1"], CAT_002),
    edition(10, "1.1", &[], CAT_010),
    edition(11, "1.3", &["1.2"], CAT_011),
    edition(20, "1.11", &["1.9", "1.10"], CAT_020),
    edition(
        21,
        "2.7",
        &["2.1", "2.2", "2.3", "2.4", "2.5", "2.6"],
        CAT_021,
    ),
    edition(21, "0.26", &["0.23", "0.24", "0.25"], CAT_021_0),
    edition(34, "1.29", &["1.27", "1.28"], CAT_034),
    edition(
        48,
        "1.32",
        &["1.27", "1.28", "1.29", "1.30", "1.31"],
        CAT_048,
    ),
    edition(
        62,
        "1.21",
        &["1.16", "1.17", "1.18", "1.19", "1.20"],
        CAT_062,
    ),
    edition(65, "1.6", &["1.4", "1.5"], CAT_065),
];

/// Editions of a category; none where its records are not read.
pub fn editions_of(category: u8) -> impl Iterator<Item = &'static Edition> {
    EDITIONS
        .iter()
        .filter(move |edition| edition.category == category)
}

/// The items of a category's records by their field references.
pub struct Uap {
    pub edition: &'static Edition,
    pub fields: Vec<Option<Field>>,
    pub fields_of_track: Option<Vec<Option<Field>>>,
}

impl Uap {
    pub fn of(edition: &'static Edition) -> Self {
        Uap {
            edition,
            fields: fields(edition.fields),
            fields_of_track: edition.fields_of_track.map(fields),
        }
    }

    /// Whether its records are those of an edition before 1.0.
    pub fn is_draft(&self) -> bool {
        self.edition.name.starts_with("0.")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of items in the specifications' tables of fields, spare and SP/RE counted.
    #[test]
    fn every_table_is_read_to_its_end() {
        let sizes = [
            (1, 21),
            (2, 14),
            (10, 28),
            (11, 29),
            (20, 28),
            (21, 49),
            (21, 35),
            (34, 14),
            (48, 28),
            (62, 35),
            (65, 14),
        ];
        for (edition, (category, size)) in EDITIONS.iter().zip(sizes) {
            let uap = Uap::of(edition);
            assert_eq!((edition.category, uap.fields.len()), (category, size));
            assert_eq!(uap.fields[0].as_ref().map(|field| field.number), Some(10));
        }
        let tracks = Uap::of(&EDITIONS[0]).fields_of_track.unwrap();
        assert_eq!(tracks.len(), 22);
    }
}
