//! What is answered to a request: UM-Bridge 1.0.

use super::http::{Request, Response};
use super::models::{Models, NoValue, Offered};
use pcc_evaluate::foundation::plural;
use serde_json::{Map, Value, json};

/// The version of the protocol.
const VERSION: f64 = 1.0;

/// What surrogates cannot be asked: their derivatives are not computed, and no memory is shared.
const UNSUPPORTED: [&str; 8] = [
    "Gradient",
    "ApplyJacobian",
    "ApplyHessian",
    "TestShMem",
    "EvaluateShMem",
    "GradientShMem",
    "ApplyJacobianShMem",
    "ApplyHessianShMem",
];

/// Inputs that are named where one is wrong.
const NAMED: usize = 8;

/// Characters of what a client wrote that are said back to it.
const SAID_BACK: usize = 60;

/// The answer to a request.
pub(crate) fn answer(models: &Models<'_>, request: &Request) -> Response {
    let answered = match (request.path.as_str(), request.method.as_str()) {
        ("Info", "GET" | "HEAD" | "POST") => Ok(info()),
        ("ModelInfo" | "InputSizes" | "OutputSizes" | "Evaluate", "POST") => asked(models, request),
        (path, "POST") if UNSUPPORTED.contains(&path) => unsupported(request),
        (path, _) => Err(nothing_there(path)),
    };
    answered.map_or_else(|refusal| refusal, Response::new)
}

fn info() -> Value {
    json!({ "protocolVersion": VERSION, "models": Offered::ALL.map(Offered::name) })
}

fn asked(models: &Models<'_>, request: &Request) -> Result<Value, Response> {
    let (model, body) = model_and_body(request)?;
    match request.path.as_str() {
        "ModelInfo" => Ok(json!({
            "support": { "Evaluate": true, "Gradient": false, "ApplyJacobian": false, "ApplyHessian": false }
        })),
        "InputSizes" => extrapolates(&body).map(|_| json!({ "inputSizes": [models.inputs().dimension()] })),
        "OutputSizes" => extrapolates(&body).map(|_| json!({ "outputSizes": [models.output_size(model)] })),
        _ => {
            let extrapolates = extrapolates(&body)?;
            let values = models.evaluate(model, &point(models, &body)?, extrapolates);
            values.map(|values| json!({ "output": [values] })).map_err(|error| match error {
                NoValue::Outside(_) => invalid(error.to_string()),
                NoValue::NotFinite { .. } => Response::error(500, "InvalidOutput", error.to_string()),
            })
        }
    }
}

/// The model that is asked for comes first: who asks for one that does not exist has not asked for a feature.
fn unsupported(request: &Request) -> Result<Value, Response> {
    let (model, _) = model_and_body(request)?;
    let message = format!("{} is not supported by {}; surrogates are evaluated only", request.path, model.name());
    Err(Response::error(400, "UnsupportedFeature", message))
}

fn nothing_there(path: &str) -> Response {
    let known = path == "Info" || ["ModelInfo", "InputSizes", "OutputSizes", "Evaluate"].contains(&path);
    if known || UNSUPPORTED.contains(&path) {
        let methods = if path == "Info" { "GET" } else { "POST with JSON" };
        return Response::error(405, "InvalidInput", format!("/{path} is asked by {methods}"));
    }
    let message = format!(
        "there is nothing at /{}; UM-Bridge has GET /Info and POST /ModelInfo, /InputSizes, /OutputSizes, /Evaluate",
        shown(path)
    );
    Response::error(404, "UnsupportedFeature", message)
}

fn model_and_body(request: &Request) -> Result<(Offered, Map<String, Value>), Response> {
    let body = match serde_json::from_slice(&request.body) {
        Ok(Value::Object(body)) => body,
        Ok(_) => return Err(invalid("the body is JSON, but no object like {\"name\": \"max_re\"}")),
        Err(_) if request.body.is_empty() => {
            return Err(invalid("there is no body; send JSON like {\"name\": \"max_re\"}"));
        }
        Err(error) => {
            return Err(invalid(format!("the body is not JSON: {error}; numbers are finite, texts in double quotes")));
        }
    };
    let names = Offered::ALL.map(Offered::name).join(", ");
    let name = match body.get("name") {
        Some(Value::String(name)) => name,
        Some(_) => return Err(invalid(format!("\"name\" is no text; it is the name of a model: {names}"))),
        None => return Err(invalid(format!("there is no \"name\"; it is the name of a model: {names}"))),
    };
    match Offered::ALL.into_iter().find(|model| model.name() == name) {
        Some(model) => Ok((model, body)),
        None => {
            let message = format!("there is no model {:?}; there are {names}", shown(name));
            Err(Response::error(400, "ModelNotFound", message))
        }
    }
}

/// The only thing that is configured. Other keys would be read over, and their sender not know.
fn extrapolates(body: &Map<String, Value>) -> Result<bool, Response> {
    let config = match body.get("config") {
        None | Some(Value::Null) => return Ok(false),
        Some(Value::Object(config)) => config,
        Some(_) => return Err(invalid("\"config\" is no object; leave it out, or send {\"extrapolate\": true}")),
    };
    if let Some(key) = config.keys().find(|key| *key != "extrapolate") {
        return Err(invalid(format!(
            "\"config\" has an unknown key {:?}; it may have \"extrapolate\" alone",
            shown(key)
        )));
    }
    match config.get("extrapolate") {
        None => Ok(false),
        Some(Value::Bool(extrapolates)) => Ok(*extrapolates),
        Some(_) => Err(invalid("\"extrapolate\" in \"config\" is neither true nor false")),
    }
}

/// The one list of numbers that every model takes.
fn point(models: &Models<'_>, body: &Map<String, Value>) -> Result<Vec<f64>, Response> {
    let inputs = models.inputs();
    let form = || {
        let names: Vec<&str> = inputs.names().take(NAMED).collect();
        let more = if inputs.dimension() > NAMED { ", …" } else { "" };
        format!("write [[{}{more}]], {} in one list", names.join(", "), plural(inputs.dimension(), "number"))
    };
    let lists = match body.get("input") {
        Some(Value::Array(lists)) => lists,
        Some(_) => return Err(invalid(format!("\"input\" is no list; {}", form()))),
        None => return Err(invalid(format!("there is no \"input\"; {}", form()))),
    };
    let [Value::Array(values)] = lists.as_slice() else {
        return Err(invalid(format!("\"input\" is not one list inside a list; {}", form())));
    };
    if values.len() != inputs.dimension() {
        return Err(invalid(format!("\"input\" has {}; {}", plural(values.len(), "number"), form())));
    }
    let number = |(name, value): (&str, &Value)| {
        let number = value.as_f64().filter(|number| number.is_finite());
        number.ok_or_else(|| invalid(format!("{name} = {} is not a finite number", shown(&value.to_string()))))
    };
    inputs.names().zip(values).map(number).collect()
}

fn invalid(message: impl Into<String>) -> Response {
    Response::error(400, "InvalidInput", message)
}

/// The beginning of what a client wrote.
fn shown(text: &str) -> String {
    match text.char_indices().nth(SAID_BACK) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
