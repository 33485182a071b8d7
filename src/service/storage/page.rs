//! Keyset paging: a cursor names the last row of a page by its time and id, so that rows added meanwhile move nothing.

use super::Storage;
use super::change::parse_id;
use super::filter::{Paging, Sort};
use super::statement::Statement;
use sqlx::Row;
use sqlx::any::AnyRow;
use uuid::Uuid;

/// Rows of a page when the caller does not say, and at most.
const LIMIT: (u32, u32) = (50, 200);

/// The end of a page.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cursor {
    pub sort: Sort,
    pub created_micros: i64,
    pub id: Uuid,
}

impl Cursor {
    /// The row of a page in this order.
    fn of_row(sort: Sort, row: &AnyRow) -> anyhow::Result<Self> {
        Ok(Cursor {
            sort,
            created_micros: row.try_get("created_at")?,
            id: parse_id(row.try_get("id")?)?,
        })
    }

    /// The opaque text of the cursor.
    pub fn encode(&self) -> String {
        let letter = if self.sort == Sort::NewestFirst {
            'n'
        } else {
            'o'
        };
        format!("{letter}{:016x}{}", self.created_micros, self.id.simple())
    }

    /// The cursor of a text, if it is one of ours and of this order.
    pub fn decode(text: &str, sort: Sort) -> Option<Self> {
        let micros = text
            .get(1..17)
            .and_then(|part| u64::from_str_radix(part, 16).ok())?;
        let id = text.get(17..).and_then(|part| Uuid::try_parse(part).ok())?;
        let cursor = Cursor {
            sort,
            created_micros: micros.cast_signed(),
            id,
        };
        (cursor.encode() == text).then_some(cursor)
    }
}

/// Rows, or what was made of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Page<Row> {
    pub items: Vec<Row>,
    /// Absent at the end of the list.
    pub next_cursor: Option<String>,
    /// Where it was asked for.
    pub total: Option<u64>,
}

impl Storage {
    /// One page of the rows that `select` selects and `condition` narrows; `count` counts such rows. `after` is the end of the page before.
    pub(super) async fn page<T>(
        &self,
        (select, count): (&'static str, &'static str),
        condition: Statement,
        (paging, after): (&Paging, Option<Cursor>),
        read: impl Fn(&AnyRow) -> anyhow::Result<T>,
    ) -> anyhow::Result<Page<T>> {
        let mut total = None;
        if paging.count {
            let count = condition.clone().after(count).count();
            total = Some(count.fetch_one(&self.read).await?.cast_unsigned());
        }
        let limit = row_limit(paging.limit);
        let mut query = condition.after(select);
        push_page(&mut query, paging.sort, after, limit);
        let mut rows = query.query().fetch_all(&self.read).await?;
        // The surplus row means that there is a next page.
        let has_more = rows.len() > limit as usize;
        rows.truncate(limit as usize);
        let last = rows.last().filter(|_| has_more);
        let next = last.map(|row| Cursor::of_row(paging.sort, row));
        Ok(Page {
            items: rows.iter().map(read).collect::<anyhow::Result<_>>()?,
            next_cursor: next.transpose()?.map(|cursor| cursor.encode()),
            total,
        })
    }
}

/// `limit` as asked for, brought into its range.
fn row_limit(asked: u32) -> u32 {
    if asked == 0 {
        LIMIT.0
    } else {
        asked.min(LIMIT.1)
    }
}

/// Restricts to the rows after the cursor, in order, one more than a page holds.
fn push_page(query: &mut Statement, sort: Sort, cursor: Option<Cursor>, limit: u32) {
    let (order, beyond) = match sort {
        Sort::NewestFirst => (" DESC", " < ("),
        Sort::OldestFirst => (" ASC", " > ("),
    };
    if let Some(cursor) = cursor {
        query
            .push(" AND (created_at, id)")
            .push(beyond)
            .bind(cursor.created_micros);
        query.push(", ").bind(cursor.id.to_string()).push(")");
    }
    query
        .push(" ORDER BY created_at")
        .push(order)
        .push(", id")
        .push(order)
        .push(" LIMIT ")
        .bind(i64::from(limit) + 1);
}

/// Restricts to rows whose name holds `q`, or whose id starts with it.
pub(super) fn push_search(query: &mut Statement, q: &str) {
    let needle = q
        .to_lowercase()
        .replace('\\', "\\\\")
        .replace('%', "\\%")
        .replace('_', "\\_");
    query
        .push(" AND (lower(coalesce(name, '')) LIKE ")
        .bind(format!("%{needle}%"));
    query
        .push(" ESCAPE '\\' OR id LIKE ")
        .bind(format!("{needle}%"))
        .push(" ESCAPE '\\')");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cursor_survives_its_text_and_nothing_else_is_one() {
        let cursor = Cursor {
            sort: Sort::NewestFirst,
            created_micros: 1_795_000_000_123_456,
            id: Uuid::now_v7(),
        };
        let text = cursor.encode();
        assert_eq!(Cursor::decode(&text, Sort::NewestFirst), Some(cursor));
        assert_eq!(
            Cursor::decode(&text, Sort::OldestFirst),
            None,
            "a cursor belongs to its order"
        );
        for wrong in [
            "",
            "n",
            "x",
            &text[..40],
            &format!("{text}0"),
            &text.to_uppercase(),
            "nüüüüüüüüüüüüüüüüüüüü",
        ] {
            assert_eq!(Cursor::decode(wrong, Sort::NewestFirst), None, "{wrong}");
        }
    }
}
