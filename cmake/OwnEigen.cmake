# Run with cmake -P on a static library: gives its weak functions of Eigen names of their own. Eigen
# is a library of templates, so the library and the program that uses it both define the functions
# that they use, and the linker keeps one definition of each. A program compiled with -mavx2 has
# functions that expect its alignment and sizes of Eigen's types, not those of the library.
execute_process(COMMAND ${NM} --format=posix --defined-only ${ARCHIVE} OUTPUT_VARIABLE symbols
                COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "_[A-Za-z0-9_.]*5Eigen[A-Za-z0-9_.]* [WVu] " weak "${symbols}")
list(REMOVE_DUPLICATES weak)
list(TRANSFORM weak REPLACE "(.*) [WVu] " "\\1 hqslam\\1\n")
string(JOIN "" renamed ${weak})
file(WRITE ${ARCHIVE}.names "${renamed}")
execute_process(COMMAND ${OBJCOPY} --redefine-syms=${ARCHIVE}.names ${ARCHIVE}
                COMMAND_ERROR_IS_FATAL ANY)
file(REMOVE ${ARCHIVE}.names)
