//! stub
pub async fn serve(_c: super::config::Config) -> anyhow::Result<()> {
    Ok(())
}
pub async fn serve_jobs(_c: super::config::Config, _j: super::jobs::Jobs) -> anyhow::Result<()> {
    Ok(())
}
