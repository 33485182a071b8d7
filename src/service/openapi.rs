//! stub
pub fn document() -> serde_json::Value {
    serde_json::Value::Null
}
pub fn document_3_0() -> serde_json::Value {
    serde_json::Value::Null
}
