# cmake -DPAGE=... -DOUTPUT=... -P embed_page.cmake: a page as a C++ source that defines page_template().
file(READ "${PAGE}" hex HEX)
string(LENGTH "${hex}" length)
math(EXPR size "${length} / 2")
# Rows of 32 bytes keep editors and compilers content.
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${hex}")
string(REGEX REPLACE "((.......){32})" "\\1\n" bytes "${bytes}")
file(WRITE "${OUTPUT}" "#include \"page_template.hpp\"\n\nnamespace {\nconstexpr char page[] = {\n${bytes}\n};\n}\n\n"
  "std::string_view sightline::cli::page_template() { return {page, ${size}}; }\n")
