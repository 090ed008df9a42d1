// The medium whose density was found above the majorant that the job states, which makes the picture wrong; -1: none.
int majorant_low = -1;

float majorant_checked(float density, float majorant, int medium)
{
    if (density > majorant) majorant_low = medium;
    return density;
}
