#include "json_text.hpp"

#include "json_writer.hpp"

namespace fringe::cli {
namespace {

void write_object(Writer& writer, const ObjectCapacitance& object) {
  writer.StartObject();
  write_text(writer, "name", object.name);
  write_number(writer, "capacitance", object.capacitance);
  write_number(writer, "bound", object.bound);
  write_flag(writer, "skipped", object.skipped);
  writer.EndObject();
}

void write_sensor(Writer& writer, const SensorCapacitance& sensor) {
  writer.StartObject();
  write_text(writer, "name", sensor.name);
  write_number(writer, "total", sensor.total);
  write_number(writer, "voltage", sensor.voltage);
  write_number(writer, "delta_voltage", sensor.delta_voltage);
  write_flag(writer, "contact", sensor.contact);
  writer.Key("objects");
  writer.StartArray();
  for (const ObjectCapacitance& object : sensor.objects)
    write_object(writer, object);
  writer.EndArray();
  writer.EndObject();
}

void write_options(Writer& writer, const CapacitanceOptions& options) {
  writer.Key("options");
  writer.StartObject();
  write_text(writer, "method", to_string(options.method));
  write_text(writer, "plates", to_string(options.plates));
  write_text(writer, "faces", to_string(options.faces));
  write_number(writer, "tolerance", options.tolerance);
  write_text(writer, "correction", to_string(options.correction));
  writer.EndObject();
}

void write_counts(Writer& writer, const EvaluationCounts& counts) {
  writer.Key("counts");
  writer.StartObject();
  write_count(writer, "triangles_evaluated", counts.triangles_evaluated);
  write_count(writer, "triangles_lumped", counts.triangles_lumped);
  write_count(writer, "triangles_skipped", counts.triangles_skipped);
  write_count(writer, "triangles_reused", counts.triangles_reused);
  write_count(writer, "nodes_lumped", counts.nodes_lumped);
  write_count(writer, "objects_evaluated", counts.objects_evaluated);
  write_count(writer, "objects_skipped", counts.objects_skipped);
  write_count(writer, "objects_reused", counts.objects_reused);
  writer.EndObject();
}

void write_reading(Writer& writer, const DistanceReading& reading) {
  writer.StartObject();
  write_text(writer, "name", reading.name);
  if (const auto& closest = reading.closest) {
    write_number(writer, "distance", closest->distance);
    write_vector(writer, "point", closest->point);
    write_text(writer, "object", closest->object);
    write_count(writer, "triangle", closest->triangle);
  } else {
    for (const char* key : {"distance", "point", "object", "triangle"}) {
      writer.Key(key);
      writer.Null();
    }
  }
  writer.EndObject();
}

void write_object(Writer& writer, const ObjectInfo& object) {
  writer.StartObject();
  write_text(writer, "name", object.name);
  write_count(writer, "triangles", object.triangles);
  write_number(writer, "area", object.area);
  writer.Key("volume");
  if (object.volume)
    write_number(writer, *object.volume);
  else
    writer.Null();
  writer.Key("aabb");
  writer.StartObject();
  write_vector(writer, "minimum", object.bounding_box.min());
  write_vector(writer, "maximum", object.bounding_box.max());
  writer.EndObject();
  writer.EndObject();
}

}  // namespace

std::string capacitance_json(const SceneCapacitance& answer, const CapacitanceOptions& options,
                             double seconds) {
  rapidjson::StringBuffer buffer;
  Writer writer(buffer);
  start_document(writer);
  write_options(writer, options);
  write_number(writer, "seconds", seconds);
  write_counts(writer, answer.counts);
  writer.Key("sensors");
  writer.StartArray();
  for (const SensorCapacitance& sensor : answer.sensors)
    write_sensor(writer, sensor);
  writer.EndArray();
  writer.EndObject();
  return buffer.GetString();
}

std::string readings_json(const std::vector<DistanceReading>& readings) {
  rapidjson::StringBuffer buffer;
  Writer writer(buffer);
  start_document(writer);
  writer.Key("distance_sensors");
  writer.StartArray();
  for (const DistanceReading& reading : readings)
    write_reading(writer, reading);
  writer.EndArray();
  writer.EndObject();
  return buffer.GetString();
}

std::string collision_json(const SceneCollision& answer, const Scene& scene) {
  rapidjson::StringBuffer buffer;
  Writer writer(buffer);
  start_document(writer);
  writer.Key("tests");
  writer.StartObject();
  write_count(writer, "broad", answer.tests.broad);
  write_count(writer, "narrow", answer.tests.narrow);
  writer.EndObject();
  writer.Key("pairs");
  writer.StartArray();
  for (const ObjectPair& pair : all_pairs(answer, scene)) {
    writer.StartObject();
    write_text(writer, "a", scene.objects[pair.a].name);
    write_text(writer, "b", scene.objects[pair.b].name);
    write_text(writer, "status", std::string(to_string(pair.status)));
    writer.EndObject();
  }
  writer.EndArray();
  writer.EndObject();
  return buffer.GetString();
}

std::string info_json(const SceneInfo& info) {
  rapidjson::StringBuffer buffer;
  Writer writer(buffer);
  start_document(writer);
  writer.Key("counts");
  writer.StartObject();
  write_count(writer, "links", info.links);
  write_count(writer, "sensors", info.sensors);
  write_count(writer, "distance_sensors", info.distance_sensors);
  write_count(writer, "objects", info.objects.size());
  write_count(writer, "triangles", info.triangles);
  writer.EndObject();
  writer.Key("objects");
  writer.StartArray();
  for (const ObjectInfo& object : info.objects)
    write_object(writer, object);
  writer.EndArray();
  writer.EndObject();
  return buffer.GetString();
}

}  // namespace fringe::cli
