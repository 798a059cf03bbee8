//! Values of attributes as plain numbers and words.

use openusd::gf::{Matrix4d, Quatd, Quatf, Quath};
use openusd::sdf::Value;

/// All numbers of a value in one row, whatever its type; a quaternion is w, x, y, z, a matrix row by row. None of a
/// value without numbers.
pub(super) fn numbers(value: &Value) -> Option<Vec<f64>> {
    let single = |all: &[f32]| all.iter().map(|&x| f64::from(x)).collect::<Vec<f64>>();
    let quatf = |q: &Quatf| single(&[q.w, q.x, q.y, q.z]);
    let quath = |q: &Quath| single(&[q.w, q.x, q.y, q.z].map(f32::from));
    let quatd = |q: &Quatd| vec![q.w, q.x, q.y, q.z];
    Some(match value {
        Value::Bool(one) => vec![f64::from(u8::from(*one))],
        Value::Uchar(one) => vec![f64::from(*one)],
        Value::Int(one) => vec![f64::from(*one)],
        Value::Uint(one) => vec![f64::from(*one)],
        Value::Int64(one) => vec![*one as f64],
        Value::Uint64(one) => vec![*one as f64],
        Value::Half(one) => vec![f64::from(*one)],
        Value::Float(one) => vec![f64::from(*one)],
        Value::Double(one) => vec![*one],
        Value::IntVec(all) => all.iter().map(|&x| f64::from(x)).collect(),
        Value::UintVec(all) => all.iter().map(|&x| f64::from(x)).collect(),
        Value::HalfVec(all) => all.iter().map(|&x| f64::from(x)).collect(),
        Value::FloatVec(all) => single(all),
        Value::DoubleVec(all) => all.clone(),
        Value::Vec2f(v) => single(&<[f32; 2]>::from(*v)),
        Value::Vec2d(v) => <[f64; 2]>::from(*v).into(),
        Value::Vec3h(v) => vec![f64::from(v.x), f64::from(v.y), f64::from(v.z)],
        Value::Vec3f(v) => single(&<[f32; 3]>::from(*v)),
        Value::Vec3d(v) => <[f64; 3]>::from(*v).into(),
        Value::Vec3i(v) => vec![f64::from(v.x), f64::from(v.y), f64::from(v.z)],
        Value::Vec3hVec(all) => all.iter().flat_map(|v| [v.x, v.y, v.z].map(f64::from)).collect(),
        Value::Vec3fVec(all) => all.iter().flat_map(|v| <[f32; 3]>::from(*v).map(f64::from)).collect(),
        Value::Vec3dVec(all) => all.iter().flat_map(|v| <[f64; 3]>::from(*v)).collect(),
        Value::Vec4f(v) => single(&<[f32; 4]>::from(*v)),
        Value::Vec4d(v) => <[f64; 4]>::from(*v).into(),
        Value::Quath(q) => quath(q),
        Value::Quatf(q) => quatf(q),
        Value::Quatd(q) => quatd(q),
        Value::Matrix4d(Matrix4d(m)) => m.to_vec(),
        _ => return None,
    })
}

/// A word: a token or a text.
pub(super) fn word(value: &Value) -> Option<String> {
    match value {
        Value::Token(word) => Some(word.as_str().to_owned()),
        Value::String(word) => Some(word.clone()),
        _ => None,
    }
}

/// A list of words.
pub(super) fn words(value: &Value) -> Option<Vec<String>> {
    match value {
        Value::TokenVec(all) => Some(all.iter().map(|word| word.as_str().to_owned()).collect()),
        Value::StringVec(all) => Some(all.clone()),
        _ => None,
    }
}
