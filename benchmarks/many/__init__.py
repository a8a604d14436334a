"""Many sensors: crowds from several of them live, and sensors shared by classifiers of which some are killed."""
