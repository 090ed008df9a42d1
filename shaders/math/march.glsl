// Set by a march that ends before its work is done: some drivers cut the loops of a pixel without notice, counting all
// iterations together.
const int MARCH_LIMIT = 60000;
bool march_was_cut = false;
