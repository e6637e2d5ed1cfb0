//! What the maintenance programs and their tests share.

/// All schemas that are shipped: the file in `schemas/`, and its text.
pub fn schemas() -> Vec<(String, String)> {
    let of_files = [
        ("surrogate.v1.schema.json".to_owned(), pcc_evaluate::artifact::schema()),
        ("study.v1.schema.json".to_owned(), pcc_compile::study::schema()),
    ];
    let of_output = |(command, text)| (format!("output/{command}.schema.json"), text);
    of_files.into_iter().chain(pcc::cli::schemas().into_iter().map(of_output)).collect()
}
