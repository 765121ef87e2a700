#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace fringe::answers {

/// Writes an answer as a JSON document: first the version of its format (geometries/schemas/FORMATS.md), then
/// the answer's keys in their order. Doubles are written with as few digits as reading them back exactly
/// needs, infinity as 1e999, which is a valid JSON number.
std::string json_text(const nlohmann::ordered_json& answer);

}  // namespace fringe::answers
