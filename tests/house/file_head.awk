# Filter of .doxyfile: makes the comment at the head of a header the documentation of its file. Diagrams and tables in it, which
# are indented, stay as they are.
NR == 1 && /^\/\/ / { print "/// \\file"; head = 1 }
!/^\/\// { head = 0 }
head { sub(/^\/\//, "///"); if (/^\/\/\/   /) sub(/^\/\/\/   /, "///     ") }
{ print }
