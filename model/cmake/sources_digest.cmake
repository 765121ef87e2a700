# Writes the function that returns a digest of the library's sources (src/io/prepared_files.hpp): cmake -DFOLDER=… -DOUTPUT=… -P …
file(GLOB_RECURSE sources RELATIVE ${FOLDER} ${FOLDER}/src/*.cpp ${FOLDER}/src/*.hpp ${FOLDER}/include/*.hpp)
list(SORT sources)
set(digests "")
foreach(source ${sources})
  file(SHA256 ${FOLDER}/${source} digest)
  string(APPEND digests "${source} ${digest}\n")
endforeach()
string(SHA256 digest "${digests}")
file(WRITE ${OUTPUT} "#include \"io/prepared_files.hpp\"

namespace fringe::detail {

const char* sources_digest() { return \"${digest}\"; }

}  // namespace fringe::detail
")
