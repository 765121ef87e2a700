#pragma once

#include <cmath>
#include <cstddef>
#include <string>

#include <Eigen/Core>
#include <rapidjson/prettywriter.h>
#include <rapidjson/stringbuffer.h>

/// Functions with which every JSON document is written.
namespace fringe::cli {

using Writer = rapidjson::PrettyWriter<rapidjson::StringBuffer>;

inline void write_text(Writer& writer, const std::string& text) {
  writer.String(text.data(), static_cast<rapidjson::SizeType>(text.size()));
}

inline void write_text(Writer& writer, const char* key, const std::string& text) {
  writer.Key(key);
  write_text(writer, text);
}

/// Writes a number; infinity as 1e999, which is a valid JSON number.
inline void write_number(Writer& writer, double number) {
  if (std::isinf(number))
    writer.RawValue("1e999", 5, rapidjson::kNumberType);
  else
    writer.Double(number);
}

inline void write_number(Writer& writer, const char* key, double number) {
  writer.Key(key);
  write_number(writer, number);
}

inline void write_count(Writer& writer, const char* key, std::size_t count) {
  writer.Key(key);
  writer.Uint64(count);
}

/// Begins a document with the version of its format (geometries/schemas/FORMATS.md).
inline void start_document(Writer& writer) {
  writer.StartObject();
  write_count(writer, "format", 1);
}

inline void write_flag(Writer& writer, const char* key, bool flag) {
  writer.Key(key);
  writer.Bool(flag);
}

inline void write_vector(Writer& writer, const char* key, const Eigen::Vector3d& vector) {
  writer.Key(key);
  writer.StartArray();
  for (const double component : vector)
    write_number(writer, component);
  writer.EndArray();
}

}  // namespace fringe::cli
