#include "import/formats.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <NCollection_DataMap.hxx>
#include <Poly_Triangulation.hxx>
#include <STEPCAFControl_ExternFile.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <StepShape_FaceSurface.hxx>
#include <StepShape_ManifoldSolidBrep.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <fmt/format.h>

#include "fringe/error.hpp"
#include "import/link_tree.hpp"
#include "import/surface_distance.hpp"

namespace fringe::cli {
namespace {

namespace fs = std::filesystem;

using ExternFiles = NCollection_DataMap<TCollection_AsciiString, Handle(STEPCAFControl_ExternFile)>;

/// Length of the library's unit, the millimetre, in metres.
constexpr double unit = 1e-3;

/// Returns the text of a file. Throws InputError unless it begins and ends as STEP does; the library reads
/// files that end early without a word.
std::string whole_text(const fs::path& path) {
  std::string text = content_of(path);
  if (text.find("ISO-10303-21;") == std::string::npos)
    throw InputError("is not a STEP file");
  if (text.find("END-ISO-10303-21;") == std::string::npos)
    throw InputError("ends early: END-ISO-10303-21 is missing");
  return text;
}

std::string name_of(const TDF_Label& label) {
  Handle(TDataStd_Name) name;
  if (!label.FindAttribute(TDataStd_Name::GetID(), name))
    return "";
  return TCollection_AsciiString(name->Get()).ToCString();
}

Eigen::Affine3d affine_of(const gp_Trsf& placement) {
  Eigen::Affine3d affine = Eigen::Affine3d::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      affine.matrix()(row, column) = placement.Value(row + 1, column + 1);
    affine.matrix()(row, 3) = unit * placement.Value(row + 1, 4);
  }
  return affine;
}

Eigen::Vector3d metres(const gp_Pnt& point) {
  return unit * Eigen::Vector3d(point.X(), point.Y(), point.Z());
}

/// Reads one file.
class StepReader {
 public:
  StepReader(const fs::path& path, std::optional<double> deflection) : path_(path) {
    const std::string text = whole_text(path);
    // It would print its messages on standard output.
    Message::DefaultMessenger()->ChangePrinters().Clear();
    reader_.SetColorMode(false);
    reader_.SetLayerMode(false);
    reader_.SetNameMode(true);
    if (reader_.ReadFile(path.c_str()) != IFSelect_RetDone)
      throw InputError("is not a STEP file that can be read");
    Handle(TDocStd_Document) document;
    XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
    if (!reader_.Transfer(document))
      throw InputError("holds no shapes that can be read");
    require_parts(text);
    tool_ = XCAFDoc_DocumentTool::ShapeTool(document->Main());
    read_names(reader_.Reader().WS());
    for (const auto& part : parts_in_files())
      read_names(part->GetWS());
    tool_->GetFreeShapes(roots_);
    import_.deflection = deflection ? *deflection : default_deflection * diagonal();
    if (!(import_.deflection > 0))
      throw InputError("holds no surfaces");
  }

  StepImport read() {
    for (const TDF_Label& root : roots_) {
      BRepMesh_IncrementalMesh mesher(XCAFDoc_ShapeTool::GetShape(root), import_.deflection / unit, false,
                                      widest_turn);
      add(root, root, std::nullopt, 0);
    }
    import_.scene = tree_.take();
    return std::move(import_);
  }

 private:
  /// Returns the files with parts that the library has found.
  std::vector<Handle(STEPCAFControl_ExternFile)> parts_in_files() const {
    std::vector<Handle(STEPCAFControl_ExternFile)> found;
    for (ExternFiles::Iterator each(reader_.ExternFiles()); each.More(); each.Next())
      found.push_back(each.Value());
    return found;
  }

  /// Throws InputError if a part of the assembly is in a file of STEP that was not read.
  void require_parts(const std::string& text) const {
    std::set<std::string> read;
    for (const auto& part : parts_in_files())
      if (part->GetLoadStatus() == IFSelect_RetDone)
        read.insert(part->GetName()->ToCString());
    static const std::regex named(R"(DOCUMENT_FILE\s*\(\s*'([^']*)')");
    for (std::sregex_iterator each(text.begin(), text.end(), named), end; each != end; ++each) {
      const std::string name = (*each)[1];
      if (const std::string extension = extension_of(name);
          !read.contains(name) && (extension == ".step" || extension == ".stp"))
        throw InputError(fmt::format(
            "a part of the assembly is in the file {}, which is not read: import it by itself, or "
            "save the assembly with its parts in one file",
            name));
    }
  }

  /// Stores the names of solids and faces of a file. Throws InputError if a face is lost.
  void read_names(const Handle(XSControl_WorkSession) & session) {
    const Handle(Transfer_TransientProcess) process = session->TransferReader()->TransientProcess();
    const Handle(Interface_InterfaceModel) model = session->Model();
    for (int i = 1; i <= model->NbEntities(); ++i) {
      const auto item = Handle(StepRepr_RepresentationItem)::DownCast(model->Value(i));
      if (item.IsNull())
        continue;
      const bool is_face = item->IsKind(STANDARD_TYPE(StepShape_FaceSurface));
      if (!is_face && !item->IsKind(STANDARD_TYPE(StepShape_ManifoldSolidBrep)))
        continue;
      const TopoDS_Shape shape = TransferBRep::ShapeResult(process, item);
      if (is_face && shape.IsNull())
        throw InputError(fmt::format("#{}: the face cannot be read", model->Number(item)));
      std::string name = item->Name().IsNull() ? "" : item->Name()->ToCString();
      if (!shape.IsNull() && !name.empty() && name != "NONE")
        names_[shape.TShape().get()] = std::move(name);
    }
  }

  double diagonal() const {
    Bnd_Box box;
    for (const TDF_Label& root : roots_)
      BRepBndLib::Add(XCAFDoc_ShapeTool::GetShape(root), box, false);
    return box.IsVoid() ? 0 : unit * box.CornerMin().Distance(box.CornerMax());
  }

  /// Adds the link of a part or of an assembly, with everything below it. `placed` is the label with the
  /// location, `label` that of the shape, which may stand in several places.
  void add(const TDF_Label& placed, const TDF_Label& label, std::optional<std::size_t> parent,
           std::size_t depth) {
    constexpr std::size_t deepest = 1000;
    std::string name = name_of(label).empty() ? name_of(placed) : name_of(label);
    if (name.empty())
      name = path_.stem().string();
    if (depth > deepest)
      throw InputError(fmt::format("\"{}\": is below more than {} others", name, deepest));
    const TopLoc_Location location = XCAFDoc_ShapeTool::GetLocation(placed);
    const std::size_t link = tree_.add_link(name, parent, split(affine_of(location.Transformation())));
    if (!XCAFDoc_ShapeTool::IsAssembly(label)) {
      TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(label);
      // The location is the link's.
      if (!location.IsIdentity() && placed == label)
        shape.Location(TopLoc_Location());
      try {
        add_part(shape, link);
      } catch (const InputError& error) {
        throw InputError(fmt::format("part \"{}\": {}", name, error.what()));
      }
      return;
    }
    TDF_LabelSequence components;
    XCAFDoc_ShapeTool::GetComponents(label, components);
    for (const TDF_Label& component : components) {
      TDF_Label referred = component;
      XCAFDoc_ShapeTool::GetReferredShape(component, referred);
      add(component, referred, link, depth + 1);
    }
  }

  /// Adds the solids of a part, then the faces that belong to no solid.
  void add_part(const TopoDS_Shape& shape, std::size_t link) {
    named_faces_.clear();
    for (TopExp_Explorer solids(shape, TopAbs_SOLID); solids.More(); solids.Next())
      add_body(solids.Current(), TopAbs_SHAPE, link);
    add_body(shape, TopAbs_SOLID, link);
    for (auto& [name, triangles] : named_faces_)
      tree_.add_object(name, link, std::move(triangles));
  }

  /// Adds the faces of a shape that are not in a shape of the type `outside_of`; those with a name are kept
  /// for later.
  void add_body(const TopoDS_Shape& shape, TopAbs_ShapeEnum outside_of, std::size_t link) {
    const auto given = names_.find(shape.TShape().get());
    std::vector<Triangle> triangles;
    for (TopExp_Explorer faces(shape, TopAbs_FACE, outside_of); faces.More(); faces.Next()) {
      const TopoDS_Face& face = TopoDS::Face(faces.Current());
      const auto name = names_.find(face.TShape().get());
      append(name == names_.end() ? triangles : named_faces_[name->second], face);
    }
    tree_.add_object(given == names_.end() ? tree_.name_of(link) : given->second, link, std::move(triangles));
  }

  /// Appends the triangles of a face and measures how far they are from its surface.
  void append(std::vector<Triangle>& triangles, const TopoDS_Face& face) {
    ++faces_;
    TopLoc_Location location;
    const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
    if (mesh.IsNull() || mesh->NbTriangles() == 0)
      throw InputError(fmt::format("face {} cannot be divided into triangles", faces_));
    const BRepAdaptor_Surface surface(face, false);
    const SurfaceDistance distance(surface, smallest_part * import_.deflection / unit);
    for (int i = 1; i <= mesh->NbTriangles(); ++i) {
      std::array<int, 3> nodes{};
      mesh->Triangle(i).Get(nodes[0], nodes[1], nodes[2]);
      if (face.Orientation() == TopAbs_REVERSED)
        std::swap(nodes[1], nodes[2]);
      Triangle triangle;
      for (std::size_t corner = 0; corner < 3; ++corner)
        triangle[corner] = metres(mesh->Node(nodes[corner]).Transformed(location.Transformation()));
      triangles.push_back(triangle);
      if (mesh->HasUVNodes())
        measure(triangle, {mesh->UVNode(nodes[0]), mesh->UVNode(nodes[1]), mesh->UVNode(nodes[2])}, distance);
    }
  }

  /// Measures how far the middles of a triangle and of its edges are from the surface.
  void measure(const Triangle& triangle, const std::array<gp_Pnt2d, 3>& parameters,
               const SurfaceDistance& distance) {
    const auto& [a, b, c] = triangle;
    for (const Eigen::Vector3d& middle : {Eigen::Vector3d((a + b + c) / 3), Eigen::Vector3d((a + b) / 2),
                                          Eigen::Vector3d((b + c) / 2), Eigen::Vector3d((c + a) / 2)}) {
      const Eigen::Vector3d point = middle / unit;
      import_.error =
          std::max(import_.error, unit * distance.of({point.x(), point.y(), point.z()}, parameters));
    }
  }

  /// Part of the deflection asked for below which a distance from the surface need not be exact.
  static constexpr double smallest_part = 0.1;

  /// Largest angle in rad between the edges and the surface: a cylinder has at least 13 sides, however small
  /// it is.
  static constexpr double widest_turn = 0.5;

  const fs::path& path_;
  STEPCAFControl_Reader reader_;
  Handle(XCAFDoc_ShapeTool) tool_;
  TDF_LabelSequence roots_;
  std::map<const TopoDS_TShape*, std::string> names_;
  std::map<std::string, std::vector<Triangle>> named_faces_;
  LinkTree tree_;
  StepImport import_{{}, 0, 0};
  std::size_t faces_ = 0;
};

}  // namespace

StepImport read_step(const fs::path& path, std::optional<double> deflection) {
  try {
    return StepReader(path, deflection).read();
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", path.string(), error.what()));
  } catch (const Standard_Failure& failure) {
    throw InputError(fmt::format("{}: {}", path.string(), failure.GetMessageString()));
  }
}

}  // namespace fringe::cli
