# Writes OUTPUT: the text of the FILES (separated by |) one after another, to be compiled at once. Each unnamed namespace
# gets a name, of PREFIX and the number of its file, so that names which are alike in two files do not collide. It is
# visible behind itself, as an unnamed namespace is.
string(REPLACE "|" ";" files "${FILES}")
set(text "")
set(number ${FIRST})
foreach(file ${files})
  file(READ "${file}" one)
  # On one line, so that lines keep their numbers.
  string(REGEX REPLACE "(^|\n)namespace {"
    "\\1namespace ${PREFIX}_${number} {} using namespace ${PREFIX}_${number}; namespace ${PREFIX}_${number} {" one "${one}")
  string(APPEND text "#line 1 \"${file}\"\n${one}\n")
  math(EXPR number "${number} + 1")
endforeach()
file(WRITE "${OUTPUT}" "${text}")
