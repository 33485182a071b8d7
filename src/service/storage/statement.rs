//! A statement put together from parts, with numbered parameters, which both databases take.

use sqlx::any::AnyArguments;
use sqlx::query::{Query, QueryScalar};
use sqlx::{Any, AssertSqlSafe};

/// SQL and the values of its parameters. Values from outside get into it by [`Statement::bind`] alone.
#[derive(Clone)]
pub(super) struct Statement {
    sql: String,
    values: Vec<Value>,
}

#[derive(Clone)]
pub(super) enum Value {
    Text(String),
    Number(i64),
}

impl From<String> for Value {
    fn from(text: String) -> Self {
        Value::Text(text)
    }
}

impl From<i64> for Value {
    fn from(number: i64) -> Self {
        Value::Number(number)
    }
}

impl Statement {
    pub fn new(sql: &'static str) -> Self {
        Statement {
            sql: sql.to_owned(),
            values: Vec::new(),
        }
    }

    /// The same after other words without parameters.
    pub fn after(mut self, sql: &'static str) -> Self {
        self.sql.insert_str(0, sql);
        self
    }

    pub fn push(&mut self, sql: &'static str) -> &mut Self {
        self.sql.push_str(sql);
        self
    }

    pub fn bind(&mut self, value: impl Into<Value>) -> &mut Self {
        self.values.push(value.into());
        self.sql.push_str(&format!("${}", self.values.len()));
        self
    }

    /// The values in parentheses, divided by commas.
    pub fn bind_list(&mut self, values: impl Iterator<Item = String>) -> &mut Self {
        self.push("(");
        for (index, value) in values.enumerate() {
            self.push(if index > 0 { ", " } else { "" }).bind(value);
        }
        self.push(")")
    }

    pub fn query(self) -> Query<'static, Any, AnyArguments> {
        let query = sqlx::query(AssertSqlSafe(self.sql));
        self.values
            .into_iter()
            .fold(query, |query, value| match value {
                Value::Text(text) => query.bind(text),
                Value::Number(number) => query.bind(number),
            })
    }

    pub fn count(self) -> QueryScalar<'static, Any, i64, AnyArguments> {
        let query = sqlx::query_scalar(AssertSqlSafe(self.sql));
        self.values
            .into_iter()
            .fold(query, |query, value| match value {
                Value::Text(text) => query.bind(text),
                Value::Number(number) => query.bind(number),
            })
    }
}
